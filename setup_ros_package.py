"""What the four setup.py files that colcon runs have in common; their facts stand in pyproject.toml."""

import tomllib
from pathlib import Path

from setuptools import find_packages, setup

ROOT = Path(__file__).resolve().parent


def setup_ros_package(package: str) -> None:
    """Set up the ROS package in the folder `package`, with the executables that pyproject.toml gives it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (maintainer,) = project["authors"]
    group = f"robustnav.executables.{package}"
    executables = project["entry-points"].get(group, {})
    commands = {name: to for name, to in project["scripts"].items() if to.startswith(f"{package}.")}
    setup(
        name=package,
        version=project["version"],
        description=project["description"],
        license=project["license"],
        maintainer=maintainer["name"],
        maintainer_email=maintainer["email"],
        packages=find_packages(include=[package, f"{package}.*"]),
        package_data={package: ["**/*"]},
        exclude_package_data={"": ["__pycache__/*"]},
        data_files=_data_files(package),
        entry_points={
            "console_scripts": [f"{name} = {to}" for name, to in (executables | commands).items()],
            group: [f"{name} = {to}" for name, to in executables.items()],
        },
        zip_safe=False,
    )


def _data_files(package: str) -> list[tuple[str, list[str]]]:
    """List what ament_python installs under share/; sources are relative to the package's folder."""
    installed = [
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ]
    folder = ROOT / package
    for path in sorted([*folder.glob("config/**/*"), *folder.glob("launch/**/*")]):
        if path.is_file() and "__pycache__" not in path.parts:
            source = path.relative_to(folder)
            installed.append((f"share/{package}/{source.parent}", [str(source)]))
    return installed
