"""The executables of the ROS packages, as their entry points say: group `robustnav.executables.PACKAGE`."""

import sys
from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points

from robustnav_msgs_py.errors import GraphError

GROUP = "robustnav.executables."


def executables() -> dict[tuple[str, str], EntryPoint]:
    """Every installed executable by (package, executable)."""
    points = entry_points()
    groups = [group for group in points.groups if group.startswith(GROUP)]
    return {
        (group.removeprefix(GROUP), point.name): point
        for group in groups
        for point in points.select(group=group)
    }


def find_executable(package: str, executable: str) -> EntryPoint:
    """The entry point of one executable; raises GraphError that lists what there is."""
    known = executables()
    if (package, executable) not in known:
        listed = ", ".join(" ".join(pair) for pair in sorted(known))
        raise GraphError(f"there is no executable {executable!r} in package {package!r}; known are: {listed}")
    return known[package, executable]


def run_executable(package: str, executable: str, arguments: Sequence[str]) -> int:
    """Run an executable in this process, as `ros2 run` would; returns its exit code."""
    main = find_executable(package, executable).load()
    sys.argv = [executable, *arguments]
    return int(main() or 0)
