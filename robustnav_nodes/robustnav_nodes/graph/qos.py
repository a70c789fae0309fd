"""Quality of service of the contract as rclpy profiles."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from robustnav_msgs_py.contract import Qos


def offered(qos: Qos) -> QoSProfile:
    """What a publisher offers: always reliable, latched where the contract says so."""
    return _profile(qos.depth, best_effort=False, latched=qos.latched)


def heard(qos: Qos) -> QoSProfile:
    """What a listener asks for."""
    return _profile(qos.hear_depth or qos.depth, best_effort=qos.hear_best_effort, latched=qos.latched)


def _profile(depth: int, *, best_effort: bool, latched: bool) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
