"""Makes the wheel answer `ros2 run`: ament index, package.xml, lib/PACKAGE/EXECUTABLE, config and launch."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

GROUP = "robustnav.executables."

# The path starts from the wrapper's own place: it works while the virtual environment is not active.
# `exec` keeps the process id: a signal from `ros2 run` or a launch file reaches the node itself.
WRAPPER = '#!/bin/sh\nexec "${{0%/*}}/../../bin/robustnav" run {package} {executable} "$@"\n'


class AmentBuildHook(BuildHookInterface[Any]):
    """Adds each ROS package's share/ and lib/ to the wheel, the editable one included."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        self._scratch = TemporaryDirectory()
        shared = build_data["shared_data"]
        for manifest in sorted(Path(self.root).glob("*/package.xml")):
            package, folder = manifest.parent.name, manifest.parent
            shared[str(manifest)] = f"share/{package}/package.xml"
            shared[str(folder / "resource" / package)] = (
                f"share/ament_index/resource_index/packages/{package}"
            )
            for data in ("config", "launch"):
                if (folder / data).is_dir():
                    shared[str(folder / data)] = f"share/{package}/{data}"
            for executable in self.metadata.core.entry_points.get(GROUP + package, {}):
                shared[str(self._wrapper(package, executable))] = f"lib/{package}/{executable}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        self._scratch.cleanup()

    def _wrapper(self, package: str, executable: str) -> Path:
        path = Path(self._scratch.name, package, executable)
        path.parent.mkdir(exist_ok=True)
        path.write_text(WRAPPER.format(package=package, executable=executable), encoding="utf-8")
        path.chmod(0o755)
        return path
