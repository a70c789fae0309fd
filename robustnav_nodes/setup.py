from pathlib import Path
from runpy import run_path

# resolve(): `colcon build --symlink-install` runs a link to this file in its build folder.
common = run_path(str(Path(__file__).resolve().parents[1] / "setup_ros_package.py"))
common["setup_ros_package"]("robustnav_nodes")
