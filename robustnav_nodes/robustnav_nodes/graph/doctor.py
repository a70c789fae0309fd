"""What is missing, mismatched or slow on this machine, and the remedy."""

import importlib.util
import os
import shutil
import sys
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from robustnav_nodes.graph.environment import DDS_PROFILE, share_directory
from robustnav_nodes.graph.executables import executables

SHM_NEEDED_MB = 256
SHM = Path("/dev/shm")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that was looked at."""

    class Level(StrEnum):
        """How it stands."""

        OK = "ok"
        NOTE = "note"
        BAD = "bad"

    level: Level
    what: str
    found: str
    remedy: str = ""


def examine() -> list[Finding]:
    """Look at everything; nothing is changed."""
    return [_python(), _ros(), _simulator(), _packages(), _dds_profile(), _shared_memory(), _cores()]


def _python() -> Finding:
    version = ".".join(str(part) for part in sys.version_info[:3])
    good = sys.version_info >= (3, 11)
    return Finding(
        level=Finding.Level.OK if good else Finding.Level.BAD,
        what="Python",
        found=version,
        remedy="" if good else "use Python 3.11 or newer",
    )


def _ros() -> Finding:
    distro = os.environ.get("ROS_DISTRO", "")
    if importlib.util.find_spec("rclpy") is None:
        remedy = "source ROS 2 Jazzy, or: pip install 'robustnav[ros]'"
        return Finding(level=Finding.Level.BAD, what="ROS 2", found="no rclpy", remedy=remedy)
    if distro not in ("", "jazzy"):
        remedy = "robustnav is made for Jazzy; other distributions are untried"
        return Finding(level=Finding.Level.NOTE, what="ROS 2", found=f"{distro}, sourced", remedy=remedy)
    return Finding(
        level=Finding.Level.OK, what="ROS 2", found=f"{distro} sourced" if distro else "from wheels"
    )


def _simulator() -> Finding:
    if importlib.util.find_spec("pybullet") is not None:
        return Finding(level=Finding.Level.OK, what="simulator", found="PyBullet")
    remedy = "pip install 'robustnav[sim]' for the demo; a robot needs no simulator"
    return Finding(level=Finding.Level.NOTE, what="simulator", found="no PyBullet", remedy=remedy)


def _packages() -> Finding:
    found = executables()
    level = Finding.Level.OK if found else Finding.Level.BAD
    remedy = "" if found else "install robustnav (pip install .) instead of running it from its folder"
    return Finding(level=level, what="executables", found=str(len(found)), remedy=remedy)


def _dds_profile() -> Finding:
    chosen = os.environ.get("FASTRTPS_DEFAULT_PROFILES_FILE", "")
    if chosen:
        there = Path(chosen).is_file()
        return Finding(
            level=Finding.Level.OK if there else Finding.Level.BAD,
            what="DDS profile",
            found=chosen,
            remedy="" if there else "FASTRTPS_DEFAULT_PROFILES_FILE names no file",
        )
    ours = share_directory("robustnav_nodes") / DDS_PROFILE
    if ours.is_file():
        return Finding(level=Finding.Level.OK, what="DDS profile", found="robustnav's own, for one machine")
    remedy = "images between processes may get lost: set FASTRTPS_DEFAULT_PROFILES_FILE"
    return Finding(level=Finding.Level.NOTE, what="DDS profile", found="none", remedy=remedy)


def _shared_memory() -> Finding:
    if not SHM.is_dir():
        return Finding(level=Finding.Level.NOTE, what="shared memory", found=f"no {SHM}", remedy="mount it")
    free_mb = shutil.disk_usage(SHM).free // 2**20
    left = sum(1 for item in SHM.iterdir() if item.name.startswith("fastrtps_"))
    if free_mb < SHM_NEEDED_MB:
        remedy = "fastdds shm clean; in a container: --shm-size=512m"
        return Finding(
            level=Finding.Level.BAD, what="shared memory", found=f"{free_mb} MB free", remedy=remedy
        )
    found = f"{free_mb} MB free, {left} segments of DDS"
    return Finding(level=Finding.Level.OK, what="shared memory", found=found)


def _cores() -> Finding:
    cores = len(os.sched_getaffinity(0))
    if cores < 2:
        remedy = "robustnav up --one-process"
        return Finding(level=Finding.Level.NOTE, what="processor cores", found=str(cores), remedy=remedy)
    return Finding(level=Finding.Level.OK, what="processor cores", found=str(cores))
