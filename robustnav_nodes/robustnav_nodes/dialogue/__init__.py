"""The dialogue: the front door for what a person says, and what the robot answers."""
