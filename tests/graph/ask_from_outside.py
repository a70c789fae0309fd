"""A person's own program: plain rclpy, nothing of robustnav, and none of its environment."""

import sys

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String

TICK_S = 0.05
TICKS = 400

rclpy.init(signal_handler_options=SignalHandlerOptions.ALL)
node = Node("somebody")
publisher = node.create_publisher(String, "/chat/from_user", 10)
for _ in range(TICKS):
    if publisher.get_subscription_count():
        break
    rclpy.spin_once(node, timeout_sec=TICK_S)
else:
    sys.exit("nobody listens on /chat/from_user")
publisher.publish(String(data=sys.argv[1]))
heard = publisher.wait_for_all_acked()
node.destroy_node()
rclpy.shutdown()
sys.exit(0 if heard else "the line was not acknowledged")
