"""Records of what a node decided and why; each travels as a DiagnosticStatus with key-value pairs."""

from dataclasses import dataclass
from enum import StrEnum


class SearchPhase(StrEnum):
    """Where a search stands."""

    IDLE = "idle"
    SEARCHING = "searching"
    DOCKING = "docking"
    FOUND = "found"
    NOT_FOUND = "not_found"
    STOPPED = "stopped"


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchState:
    """How the search stands. `episode` counts searches since the planner started; lengths in metres."""

    phase: SearchPhase = SearchPhase.IDLE
    target: str = ""
    episode: int = 0
    step: int = 0
    max_steps: int = 0
    path_length_m: float = 0.0
    p_best: float = 0.0
    best_x_m: float = 0.0
    best_y_m: float = 0.0
    message: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """One decision of the planner: what was chosen, and how every legal action looked.

    `actions`, `values` and `visits` have one entry per legal action: what the planner expects of it (NaN: not
    tried) and number of simulations. `tau` is the probability in view at which the search ends, `p_in_view`
    what it is now.
    `x_m`, `y_m`, `yaw_rad` is where the robot decided, `goal_...` where the action leads.
    """

    episode: int
    step: int
    planner: str
    action: str
    actions: tuple[str, ...]
    values: tuple[float, ...]
    visits: tuple[int, ...]
    simulations: int
    elapsed_ms: float
    p_in_view: float
    tau: float
    entropy: float
    x_m: float
    y_m: float
    yaw_rad: float
    goal_x_m: float
    goal_y_m: float
    goal_yaw_rad: float
    reason: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectorRecord:
    """What is believed of the detector on class `label`, what was assumed, and the counts between the two.

    Of looks that had the target in view it was `detected` and `missed`; of firings some were right.
    """

    label: str
    precision: float
    recall: float
    precision_assumed: float
    recall_assumed: float
    detected: float
    missed: float
    true_firings: float
    false_firings: float

    @property
    def summary(self) -> str:
        """In a line."""
        looks, firings = self.detected + self.missed, self.true_firings + self.false_firings
        return (
            f"precision {self.precision:.2f} (assumed {self.precision_assumed:.2f}), "
            f"recall {self.recall:.2f} (assumed {self.recall_assumed:.2f}), "
            f"after {looks:.0f} looks and {firings:.0f} firings"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Episode:
    """Ground truth about a simulated run: what decided it and where the robot began."""

    seed: int
    home: str
    rooms: tuple[str, ...]
    start_x_m: float
    start_y_m: float
    start_yaw_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DialogueState:
    """What the dialogue is about; `last_heard` and `last_said` are shortened for display."""

    scenario: str = "search"
    target: str = ""
    lines_heard: int = 0
    last_heard: str = ""
    last_said: str = ""
