"""After `pip install`, a ROS command finds the packages and starts their executables."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from zipfile import ZipFile

import pytest
from ament_index_python.packages import get_package_prefix

Executables = dict[str, dict[str, str]]
PREFIX = Path(sys.prefix)


def test_ament_index_finds_every_package(executables: Executables, monkeypatch: pytest.MonkeyPatch) -> None:
    """`ros2 pkg prefix` answers with the virtual environment, and package.xml is where ROS looks."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)
    for package in executables:
        assert Path(get_package_prefix(package)) == PREFIX
        assert (PREFIX / "share" / package / "package.xml").is_file()


def test_executables_are_where_ros2_run_looks(executables: Executables) -> None:
    """lib/PACKAGE holds the executables of pyproject.toml and nothing else."""
    for package, names in executables.items():
        found = [path.name for path in (PREFIX / "lib" / package).glob("*") if os.access(path, os.X_OK)]
        assert sorted(found) == sorted(names)


def test_wrapper_hands_over_process_and_arguments(tmp_path: Path) -> None:
    """The wrapper becomes `robustnav run` of its own prefix: same process id, same arguments."""
    wrapper = tmp_path / "lib" / "robustnav_nodes" / "belief"
    command = tmp_path / "bin" / "robustnav"
    wrapper.parent.mkdir(parents=True)
    command.parent.mkdir()
    shutil.copy(PREFIX / "lib" / "robustnav_nodes" / "belief", wrapper)
    command.write_text('#!/bin/sh\nprintf "%s\\n" $$ "$@"\n', encoding="utf-8")
    command.chmod(0o755)
    given = ["--ros-args", "-p", "name:=a b", ""]
    started = subprocess.Popen([wrapper, *given], env={}, stdout=subprocess.PIPE, text=True)
    said, _ = started.communicate(timeout=20)
    assert said.split("\n")[:-1] == [str(started.pid), "run", "robustnav_nodes", "belief", *given]


def test_installed_node_starts_and_stops(
    starts_and_stops: Callable[[Path, Mapping[str, str]], None],
) -> None:
    """The file that `ros2 run robustnav_nodes belief` executes is a node that ends cleanly on SIGINT."""
    starts_and_stops(PREFIX / "lib" / "robustnav_nodes" / "belief", os.environ)


def test_wheel_holds_what_ros_needs(
    root: Path, executables: Executables, build: Callable[[str, Path], Path]
) -> None:
    """Index entries, manifests, executables, config, launch files and modules are in, and nothing else."""
    wanted = set()
    for package, names in executables.items():
        wanted |= {f"share/ament_index/resource_index/packages/{package}", f"share/{package}/package.xml"}
        wanted |= {f"lib/{package}/{name}" for name in names}
        folder = root / package
        data = [*folder.glob("config/**/*"), *folder.glob("launch/**/*")]
        wanted |= {f"share/{package}/{path.relative_to(folder)}" for path in data if _is_source(path)}
        wanted |= {
            str(path.relative_to(folder)) for path in (folder / package).rglob("*") if _is_source(path)
        }
    modes = _modes(build("wheel", root))
    assert wanted == {name for name in modes if ".dist-info/" not in name}
    assert all(modes[name] & 0o111 for name in wanted if name.startswith("lib/"))


def test_release_builds_the_same_wheel(root: Path, release: Path, build: Callable[[str, Path], Path]) -> None:
    """A source release lacks nothing that the wheel needs."""
    assert _modes(build("wheel", release)) == _modes(build("wheel", root))


def _is_source(path: Path) -> bool:
    return path.is_file() and "__pycache__" not in path.parts


def _modes(wheel: Path) -> dict[str, int]:
    """Give each file's mode by the name under which pip installs it."""
    with ZipFile(wheel) as archive:
        return {
            entry.filename.partition(".data/data/")[2] or entry.filename: entry.external_attr >> 16
            for entry in archive.infolist()
        }
