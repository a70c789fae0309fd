"""Laser scans: sensor_msgs/LaserScan."""

from typing import Any

import numpy as np

from robustnav_msgs_py.conversions.arrays import from_array, to_array
from robustnav_msgs_py.conversions.stamps import header, stamp_from_message
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import LaserScan as LaserScanMessage
from robustnav_msgs_py.values import LaserScan


def scan_to_message(scan: LaserScan) -> LaserScanMessage:
    """A LaserScan taken at one instant."""
    return LaserScanMessage(
        header=header(scan.stamp_ns, scan.frame_id),
        angle_min=float(scan.angle_min_rad),
        angle_max=float(scan.angle_min_rad + scan.angle_step_rad * (len(scan.ranges_m) - 1)),
        angle_increment=float(scan.angle_step_rad),
        range_min=float(scan.range_min_m),
        range_max=float(scan.range_max_m),
        ranges=to_array(scan.ranges_m),
    )


def scan_from_message(message: Any) -> LaserScan:
    """Read a LaserScan; refused when it has no ranges or no angle between them."""
    ranges = from_array(message.ranges, np.float32)
    if not ranges.size or not message.angle_increment:
        raise BadMessageError(
            f"a scan has {ranges.size} ranges, {message.angle_increment!r} rad apart; it says nothing"
        )
    return LaserScan(
        ranges_m=ranges.copy(),
        angle_min_rad=float(message.angle_min),
        angle_step_rad=float(message.angle_increment),
        range_min_m=float(message.range_min),
        range_max_m=float(message.range_max),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )
