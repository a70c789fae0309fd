"""What must be repeated outside pyproject.toml agrees with it."""

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from importlib.metadata import EntryPoint, distribution
from pathlib import Path
from typing import Any

import pytest
from ament_index_python.packages import get_packages_with_prefixes
from catkin_pkg.package import Package, parse_package

Executables = dict[str, dict[str, str]]


@pytest.fixture(scope="module")
def manifests(root: Path, executables: Executables) -> dict[str, Package]:
    """Read every package.xml; parsing refuses what the ROS format (REP 149) does not allow."""
    return {package: parse_package(str(root / package / "package.xml")) for package in executables}


def test_manifests_repeat_pyproject(manifests: dict[str, Package], pyproject: dict[str, Any]) -> None:
    """Version, license and maintainer in each package.xml are those of pyproject.toml."""
    project = pyproject["project"]
    for package, manifest in manifests.items():
        assert manifest.name == package
        assert manifest.version == project["version"]
        assert manifest.licenses == [project["license"]]
        assert [{"name": m.name, "email": m.email} for m in manifest.maintainers] == project["authors"]
        assert manifest.get_build_type() == "ament_python"


def test_installed_version_is_pyprojects(pyproject: dict[str, Any]) -> None:
    """The tests run against what pyproject.toml describes now, not against an older installation."""
    assert distribution("robustnav").version == pyproject["project"]["version"]


def test_setup_py_takes_its_facts_from_pyproject(
    root: Path, executables: Executables, pyproject: dict[str, Any]
) -> None:
    """What colcon asks each setup.py, name and version, is answered from pyproject.toml."""
    for package in executables:
        command = [sys.executable, "setup.py", "--name", "--version"]
        answer = subprocess.run(
            command, cwd=root / package, check=True, stdout=subprocess.PIPE, text=True, timeout=60
        )
        assert answer.stdout.split() == [package, pyproject["project"]["version"]]


def test_installed_executables_are_pyprojects(executables: Executables) -> None:
    """`robustnav run` finds exactly the executables that pyproject.toml names."""
    installed = {
        package: {entry.name: entry.value for entry in _installed(package)} for package in executables
    }
    assert installed == executables


def test_every_executable_is_a_function(executables: Executables) -> None:
    """No entry point names a module or a function that is not there."""
    for package in executables:
        for entry in _installed(package):
            assert callable(entry.load()), entry


def test_no_package_needs_one_that_needs_it(manifests: dict[str, Package]) -> None:
    """The manifests give colcon an order to build in; a cycle would raise here."""
    needs = {package: _declared(manifest) & manifests.keys() for package, manifest in manifests.items()}
    assert set(TopologicalSorter(needs).static_order()) == manifests.keys()


def test_imported_ros_packages_are_declared(
    root: Path, manifests: dict[str, Package], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A ROS package imported at the top of a module stands in package.xml, so that rosdep installs it.

    What is imported in a function or in a `try` may be missing, and is not looked at.
    """
    if "AMENT_PREFIX_PATH" not in os.environ:
        monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)
    ros_packages = set(get_packages_with_prefixes())
    for package, manifest in manifests.items():
        imported = {name for path in (root / package).rglob("*.py") for name in _imports(path)}
        missing = (imported & ros_packages) - _declared(manifest) - {package}
        assert not missing, f"{package} imports {missing}, which its package.xml does not name"


def _installed(package: str) -> Iterator[EntryPoint]:
    group = f"robustnav.executables.{package}"
    return (entry for entry in distribution("robustnav").entry_points if entry.group == group)


def _declared(manifest: Package) -> set[str]:
    return {dependency.name for dependency in manifest.exec_depends}


def _imports(path: Path) -> Iterator[str]:
    for statement in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in statement.names)
        elif isinstance(statement, ast.ImportFrom) and statement.module:
            yield statement.module.partition(".")[0]
