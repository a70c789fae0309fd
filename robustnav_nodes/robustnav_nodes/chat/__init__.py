"""Ways for a person to talk to the robot."""
