"""Record runs to MCAP bags that every ROS 2 tool opens; read, describe, measure and draw them."""
