"""Claims about the robot, each found by simulating it."""
