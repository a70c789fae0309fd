"""Which code runs here: the version, the commit of the checkout, and the packages that results depend on."""

import platform
import subprocess
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from bags.manifest import Manifest, PackageVersion

DISTRIBUTION = "robustnav"
PACKAGES = ("rclpy", "numpy", "numba", "scipy", "torch", "pybullet", "mcap", "rosbags")
GIT_LIMIT_S = 5.0


def manifest_of_this_run(source: Path) -> Manifest:
    """A manifest with what this process knows by itself, at this moment.

    `source` is a file or folder of the code; its git checkout, if it lies in one, gives the commit.
    """
    commit, changed = checkout_state(source)
    return Manifest(
        version=_installed_version(DISTRIBUTION),
        wall_start_ns=time.time_ns(),
        commit=commit,
        uncommitted_changes=changed,
        platform=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        packages=tuple(
            PackageVersion(package=name, version=installed)
            for name in PACKAGES
            if (installed := _installed_version(name))
        ),
    )


def checkout_state(source: Path) -> tuple[str, bool]:
    """Commit of the checkout that tracks `source`, and whether files differ from it; ("", False) in none."""
    folder = source if source.is_dir() else source.parent
    # An installed package may lie inside some other project's checkout (a virtual environment there):
    # only a file that git tracks tells that the commit is the code's.
    if not _git(folder, "ls-files", str(source)):
        return "", False
    return _git(folder, "rev-parse", "HEAD"), bool(_git(folder, "status", "--porcelain"))


def _git(folder: Path, *arguments: str) -> str:
    """Output of a git command in `folder`, "" where it fails or git is not there."""
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True,
            text=True,
            timeout=GIT_LIMIT_S,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()


def _installed_version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return ""
