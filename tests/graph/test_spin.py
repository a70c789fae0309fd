"""Nodes that share a process leave in an order that is safe for the robot."""

import subprocess
import sys
from pathlib import Path

TWO_NODES = Path(__file__).parent / "two_nodes.py"


def test_all_nodes_stop_before_the_first_cleans_up() -> None:
    """Cleaning up waits for those that lag; the robot must not drive on meanwhile."""
    done = subprocess.run(
        [sys.executable, str(TWO_NODES)], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    told = ["dialogue stops", "planner stops", "dialogue cleans up", "planner cleans up"]
    assert done.stdout.splitlines() == told
