"""How hard the program is to break: hostile inputs, kills, full disks, cut links, long sessions. Bounded, no tests."""
