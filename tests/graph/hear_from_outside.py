"""A person's own program: plain rclpy, prints what the robot has said once it has said the last word."""

import contextlib
import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String

LAST_WORD = sys.argv[1]

rclpy.init(signal_handler_options=SignalHandlerOptions.ALL)
node = Node("somebody")
heard: list[str] = []
node.create_subscription(String, "/chat/to_user", lambda message: heard.append(message.data), 10)
print("listening", flush=True)
with contextlib.suppress(ExternalShutdownException):
    while LAST_WORD not in heard:
        rclpy.spin_once(node)
print(*heard, flush=True)
node.destroy_node()
rclpy.try_shutdown()
