"""Records one search in lock-step: `python lockstep_search.py FOLDER`, in a process of its own."""

import sys
from pathlib import Path

from rich.console import Console

from bags.lockstep_demo import run_lockstep_demo
from robustnav_nodes.graph.demo import DemoEnd
from robustnav_nodes.graph.search_graph import RunPlan

SEED = 3
LIMIT_S = 120.0


def plan_of(bag: Path | None) -> RunPlan:
    """A home of one room, a small picture, and a detector that never errs."""
    return RunPlan(
        seed=SEED,
        bag=bag,
        parameters={
            "sim_bridge": {
                "real_time_factor": 1.0,
                "difficulty": "easy",
                "camera_width": 80,
                "camera_height": 60,
            },
            "detection": {"recall": 1.0, "precision": 1.0},
        },
    )


def record(folder: Path) -> DemoEnd:
    """One search; its bag is `folder`/bag."""
    bag = folder / "bag"
    return run_lockstep_demo(
        plan_of(bag), bag=bag, console=Console(quiet=True), log_folder=folder, limit_s=LIMIT_S
    )


if __name__ == "__main__":
    sys.exit(int(record(Path(sys.argv[1])).timed_out))
