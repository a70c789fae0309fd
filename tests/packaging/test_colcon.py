"""A checkout in a colcon workspace builds, and ROS starts the nodes from there."""

import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix

Executables = dict[str, dict[str, str]]


@pytest.mark.parametrize("options", [[], ["--symlink-install"]], ids=["copied", "linked"])
def test_workspace_builds_and_runs(
    options: list[str],
    release: Path,
    root: Path,
    executables: Executables,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    starts_and_stops: Callable[[Path, Mapping[str, str]], None],
) -> None:
    """colcon installs every executable and data file; `belief` starts from the workspace's own modules."""
    shutil.copytree(release, tmp_path / "src" / "robustnav")
    colcon = Path(sysconfig.get_path("scripts"), "colcon")
    subprocess.run([colcon, "build", *options], cwd=tmp_path, check=True, timeout=120)
    environment = _sourced(tmp_path / "install" / "setup.sh")

    monkeypatch.setenv("AMENT_PREFIX_PATH", environment["AMENT_PREFIX_PATH"])
    for package, names in executables.items():
        prefix = Path(get_package_prefix(package))
        assert prefix == tmp_path / "install" / package
        assert names.keys() <= {path.name for path in (prefix / "lib" / package).glob("*")}
        for data in ("config", "launch"):
            assert _files(prefix / "share" / package / data) == _files(root / package / data)

    asked = [sys.executable, "-c", "import robustnav_nodes; print(robustnav_nodes.__file__)"]
    answer = subprocess.run(
        asked, cwd=tmp_path, env=environment, check=True, stdout=subprocess.PIPE, text=True, timeout=60
    )
    assert Path(answer.stdout.strip()).is_relative_to(tmp_path)
    starts_and_stops(Path(get_package_prefix("robustnav_nodes"), "lib/robustnav_nodes/belief"), environment)


def _sourced(script: Path) -> dict[str, str]:
    """Return the environment that a shell has after sourcing a script."""
    command = ["sh", "-c", '. "$0" >&2 && exec env -0', script]
    printed = subprocess.run(command, env=os.environ, check=True, stdout=subprocess.PIPE, timeout=60).stdout
    return dict(line.split("=", 1) for line in printed.decode().split("\0") if line)


def _files(folder: Path) -> set[Path]:
    paths = {path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    return {path.relative_to(folder) for path in paths}
