"""A load for the recorder: images and small messages at given rates, each with a number of its own.

`python -m bags.recorder_load MB_PER_S MESSAGES_PER_S SECONDS` waits until every topic is heard, speaks, and
prints a line of JSON: how many messages were said on each topic, and how long that took.
"""

import json
import struct
import sys
import time
from dataclasses import dataclass

import numpy as np
import rclpy
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Image

from robustnav_nodes.graph.environment import prepare_environment

NAMESPACE = "/recorder_load"
IMAGE_TOPICS = 2
SMALL_TOPICS = 10
WIDTH, HEIGHT = 640, 480
IMAGE_BYTES = WIDTH * HEIGHT * 3
TICK_S = 0.01
# A message's number stands where its header's stamp is, after the four bytes that begin CDR.
NUMBER_AT = 4
NUMBER = struct.Struct("<iI")  # seconds, nanoseconds
HEARD_LIMIT_S = 20.0
ACKNOWLEDGED_LIMIT_S = 10.0
IMAGE_DEPTH, SMALL_DEPTH = 20, 1000


def number_of(data: bytes) -> int:
    """The number in a message of this load."""
    return int(NUMBER.unpack_from(data, NUMBER_AT)[1])


@dataclass(slots=True)
class _Speaker:
    """One topic: a serialized message that is said again and again with the next number."""

    topic: str
    publisher: Publisher
    data: bytearray
    period_s: float
    said: int = 0

    def speak(self, elapsed_s: float) -> None:
        """Say what is due `elapsed_s` after the begin."""
        while self.said * self.period_s <= elapsed_s:
            NUMBER.pack_into(self.data, NUMBER_AT, 0, self.said)
            self.publisher.publish(bytes(self.data))
            self.said += 1


def camera_image() -> Image:
    """A picture as hard to compress as a camera's: slopes, and two bits of noise in each pixel."""
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    slopes = (rows // 4 + columns // 8)[..., None] + np.array([0, 40, 80])
    noise = np.random.default_rng(1).integers(0, 4, slopes.shape)
    pixels = ((slopes + noise) % 256).astype(np.uint8)
    image = Image(height=HEIGHT, width=WIDTH, encoding="rgb8", step=WIDTH * 3)
    image.header.frame_id = "camera"
    image.data.frombytes(pixels.tobytes())
    return image


def _speakers(node: Node, mb_per_s: float, messages_per_s: float) -> list[_Speaker]:
    odometry = Odometry(child_frame_id="base_link")
    odometry.header.frame_id = "odom"
    kinds = [
        (Image, "image", camera_image(), IMAGE_TOPICS, mb_per_s * 1e6 / IMAGE_BYTES, IMAGE_DEPTH),
        (Odometry, "small", odometry, SMALL_TOPICS, messages_per_s, SMALL_DEPTH),
    ]
    return [
        _Speaker(
            topic=f"{NAMESPACE}/{name}_{number}",
            publisher=node.create_publisher(kind, f"{NAMESPACE}/{name}_{number}", QoSProfile(depth=depth)),
            data=bytearray(serialize_message(message)),
            period_s=count / rate_hz,
        )
        for kind, name, message, count, rate_hz, depth in kinds
        for number in range(count)
        if rate_hz > 0
    ]


def speak(node: Node, *, mb_per_s: float, messages_per_s: float, seconds: float) -> dict[str, object]:
    """Say the load; returns counts by topic and the seconds that it took."""
    speakers = _speakers(node, mb_per_s, messages_per_s)
    deadline_s = time.monotonic() + HEARD_LIMIT_S
    while any(speaker.publisher.get_subscription_count() < 1 for speaker in speakers):
        if time.monotonic() > deadline_s:
            raise SystemExit("no recorder hears the load")
        time.sleep(TICK_S)
    begun_s = time.monotonic()
    while (elapsed_s := time.monotonic() - begun_s) < seconds:
        for speaker in speakers:
            speaker.speak(elapsed_s)
        time.sleep(TICK_S)
    took_s = time.monotonic() - begun_s
    for speaker in speakers:
        speaker.publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGED_LIMIT_S))
    return {"said": {speaker.topic: speaker.said for speaker in speakers}, "seconds": took_s}


def main() -> None:
    """Speak, and print what was said."""
    prepare_environment()
    mb_per_s, messages_per_s, seconds = (float(word) for word in sys.argv[1:4])
    rclpy.init(args=[])
    node = rclpy.create_node("recorder_load")
    try:
        told = speak(node, mb_per_s=mb_per_s, messages_per_s=messages_per_s, seconds=seconds)
        print(json.dumps(told), flush=True)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
