"""Joint values at which a frame of the robot has a wanted pose, and why there are none."""
