"""A simulated home and robot in PyBullet; to the rest of the graph it is a robot."""
