"""One search in a simulated home, through the real nodes in lock-step, by a detector that looks at pixels."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robustnav_msgs_py.conversions import record_from_message
from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_nodes.benchmarks.contestants import Contestant
from robustnav_nodes.benchmarks.graph_bench import GraphEpisode, measured
from robustnav_nodes.graph.demo import FAREWELL_S
from robustnav_nodes.graph.search_graph import RunPlan

if TYPE_CHECKING:  # these stand on this package
    from robustnav_nodes.graph.lockstep import Said
    from sim_bridge.sensors.degradations import ImageDegradation

# A robot that stands is seen from in half a second; more images show the same.
CAMERA_HZ, SCAN_HZ = 2.0, 0.5
# A decision is made of simulations alone: the same on a slow machine.
NO_TIME_LIMIT_S = 60.0
SECONDS_PER_STEP = 8.0
UNDER_WAY = (SearchPhase.IDLE, SearchPhase.SEARCHING, SearchPhase.DOCKING)


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeSearch:
    """What is searched for, where, by whom, and what they believe of the detector.

    target: a class, "": one of which the home of `seed` holds a single object. statistics: file of the
    detector's statistics. learnt: file of what is learnt of the detector from search to search, None: nothing
    is. detection: parameters of the detection node.
    """

    seed: int
    difficulty: str
    contestant: Contestant
    statistics: Path
    max_steps: int
    target: str = ""
    learnt: Path | None = None
    camera: "ImageDegradation | None" = None
    detection: Mapping[str, Any] = field(default_factory=dict)

    def plan(self) -> RunPlan:
        """The run of the graph."""
        settings = self.contestant.settings()
        statistics = {"detector_statistics_file": str(self.statistics)}
        learning = {
            "learn_statistics": self.learnt is not None,
            "online_statistics_file": "" if self.learnt is None else str(self.learnt),
        }
        return RunPlan(
            seed=self.seed,
            parameters={
                "sim_bridge": {
                    "difficulty": self.difficulty,
                    "camera_hz": CAMERA_HZ,
                    "scan_hz": SCAN_HZ,
                    **({} if self.camera is None else asdict(self.camera)),
                },
                "detection": dict(self.detection),
                "belief": {**settings["belief"], **statistics, **learning},
                "planner": {
                    **settings["planner"],
                    **statistics,
                    "max_steps": self.max_steps,
                    "time_budget_s": NO_TIME_LIMIT_S,
                },
                "simulated_user": {"target": self.target},
            },
        )


def run_home_search(search: HomeSearch, bag: Path) -> GraphEpisode:
    """Search in this process; what is needed to measure it is recorded in `bag`, its parameters beside it.

    Raises RobustnavError where a node does not come up or the bag cannot be measured.
    """
    from bags.lockstep_recording import LockstepRecording
    from bags.search_run import TOPICS
    from robustnav_nodes.graph.lockstep_run import LockstepRun

    plan = search.plan()
    files = plan.write_parameters(bag.with_name(f"{bag.name}.yaml"))
    wanted = {*TOPICS, "truth/episode"}
    phase = SearchPhase.IDLE
    with LockstepRecording(bag) as recording:

        def watch(said: "Said") -> None:
            nonlocal phase
            if said.row.name in wanted:
                recording.take(said)
            if said.row.name == "search/state":
                phase = record_from_message(said.message, SearchState).phase

        with LockstepRun(plan, files, watch) as run:
            recording.note_parameters(run)
            run.run(lambda: phase not in UNDER_WAY, SECONDS_PER_STEP * search.max_steps)
            run.run(lambda: False, FAREWELL_S)  # the person says what they think of it
    return measured(search.seed, bag)
