"""The environment variables that ROS 2 from wheels needs, set where the user has not set them."""

import os
import sys
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

DDS_PROFILE = "config/fastdds_local.xml"


def prepare_environment(*, local: bool | None = None) -> None:
    """Set what is missing, before `rclpy.init` and for the processes started from here.

    local: keep the graph on this machine (loopback only, large shared-memory segment, quick discovery).
    None decides by where ROS comes from: a sourced ROS is left as its owner set it up.
    """
    os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
    os.environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")  # a wrong field type is an error, not garbage
    if local is None:
        local = "ROS_DISTRO" not in os.environ
    if not local:
        return
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    profile = share_directory("robustnav_nodes") / DDS_PROFILE
    if profile.is_file():
        os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(profile))


def share_directory(package: str) -> Path:
    """Where the data files of a ROS package lie: after pip install, and after colcon build."""
    try:
        return Path(get_package_share_directory(package))
    except (PackageNotFoundError, OSError):
        return Path(sys.prefix) / "share" / package
