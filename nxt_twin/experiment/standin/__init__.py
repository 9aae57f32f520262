"""Stand-ins for what an experiment needs and a test has not: a hand, a robot's controller, a rig round the mock."""
