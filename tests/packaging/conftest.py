"""What the packaging tests share: the facts of pyproject.toml, a release, and how an executable is tried."""

import os
import re
import selectors
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

START_S = 60.0
STOP_S = 20.0


@pytest.fixture(scope="session")
def root() -> Path:
    return Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def pyproject(root: Path) -> dict[str, Any]:
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def executables(pyproject: dict[str, Any]) -> dict[str, dict[str, str]]:
    """Give for each ROS package the names of its executables and the functions behind them."""
    packages = pyproject["tool"]["hatch"]["build"]["dev-mode-dirs"]
    groups = pyproject["project"]["entry-points"]
    return {package: groups.get(f"robustnav.executables.{package}", {}) for package in packages}


@pytest.fixture(scope="session")
def build(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Path], Path]:
    """Build an `sdist` or a `wheel` of a source tree, as pip would, and return the file."""

    def hatch(target: str, tree: Path) -> Path:
        into = tmp_path_factory.mktemp(target)
        command = [sys.executable, "-m", "hatchling", "build", "-t", target, "-d", str(into)]
        subprocess.run(command, cwd=tree, check=True, timeout=60)
        (built,) = into.iterdir()
        return built

    return hatch


@pytest.fixture(scope="session")
def release(root: Path, build: Callable[[str, Path], Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Unpack a source release: the checkout without what git ignores."""
    unpacked = tmp_path_factory.mktemp("release")
    shutil.unpack_archive(build("sdist", root), unpacked)
    (tree,) = unpacked.iterdir()
    return tree


@pytest.fixture
def starts_and_stops(tmp_path: Path) -> Callable[[Path, Mapping[str, str]], None]:
    """Start a node's executable, wait until it says that it is active, interrupt it, and want exit code 0."""

    def check(executable: Path, environment: Mapping[str, str]) -> None:
        quiet = {"ROS_LOG_DIR": str(tmp_path), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        node = subprocess.Popen(
            [executable], env={**environment, **quiet}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        try:
            _read_until(rb"\bactive\b", node, START_S)
            node.send_signal(signal.SIGINT)
            rest, _ = node.communicate(timeout=STOP_S)
            assert node.returncode == 0, rest.decode()
        finally:
            node.kill()
            node.wait()

    return check


def _read_until(pattern: bytes, process: subprocess.Popen[bytes], timeout_s: float) -> None:
    assert process.stdout is not None
    deadline = time.monotonic() + timeout_s
    said = b""
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        while not re.search(pattern, said):
            assert selector.select(deadline - time.monotonic()), (
                f"no {pattern!r} in {timeout_s} s: {said.decode()}"
            )
            chunk = os.read(process.stdout.fileno(), 65536)
            assert chunk, f"ended without {pattern!r}: {said.decode()}"
            said += chunk
