"""The nodes of robustnav: one sub-package per capability, ROS-free modules and one thin node.py each."""
