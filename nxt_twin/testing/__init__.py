"""For test suites: mock bricks as pytest fixtures, and checks that any brick has to pass."""
