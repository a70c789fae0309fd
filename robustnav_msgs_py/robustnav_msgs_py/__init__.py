"""Values of robustnav, their standard ROS 2 messages, and the contract of topics and services."""
