"""What the demo shows while it runs, and when the run is over."""

import time
from collections.abc import Callable

from rich.console import Console

from robustnav_msgs_py.records import Decision, SearchPhase, SearchState

STEPS_PER_LINE = 3
ENDED = (SearchPhase.FOUND, SearchPhase.NOT_FOUND, SearchPhase.STOPPED)


class DemoScreen:
    """Prints the search, the decisions and the chat as they are said; `clock` gives the seconds it shows."""

    def __init__(self, console: Console, clock: Callable[[], float] = time.monotonic) -> None:
        self.search = SearchState()
        self._console = console
        self._clock = clock
        self._began_s = clock()
        self._told, self._thanked = False, False
        self._shown_step = 0

    @property
    def elapsed_s(self) -> float:
        """Since the screen was made."""
        return self._clock() - self._began_s

    @property
    def is_over(self) -> bool:
        """Whether the search has ended."""
        return self.search.phase in ENDED

    def is_said(self, *, with_person: bool) -> bool:
        """Whether the robot has told the end, and the person has thanked."""
        return self._told and (self._thanked or not with_person)

    def on_state(self, search: SearchState) -> None:
        """The search goes on."""
        before, self.search = self.search, search
        if search.phase != before.phase and search.phase is not SearchPhase.IDLE:
            self.say(f"[bold cyan]{search.phase.replace('_', ' ')}[/] ", f"{search.target}  {search.message}")
        if search.episode != before.episode:
            self._shown_step = 0

    def on_decision(self, decision: Decision) -> None:
        """The planner has decided; every third decision is shown."""
        if decision.step - self._shown_step < STEPS_PER_LINE and decision.step > 1:
            return
        self._shown_step = decision.step
        here = f"at ({decision.x_m:4.1f}, {decision.y_m:4.1f}) m"
        best = self.search
        likely = f"likeliest p {best.p_best:.3f} at ({best.best_x_m:.1f}, {best.best_y_m:.1f})"
        self.say(
            f"step {decision.step:3d}  ",
            f"{here}  {decision.action:10s} {likely}  in view {decision.p_in_view:.3f} of {decision.tau:.3f}"
            f"  unsure {100 * decision.entropy:3.0f} %",
        )

    def on_chat(self, who: str, line: str) -> None:
        """A line of the conversation."""
        self.say(f"[bold {'green' if who == 'person' else 'yellow'}]{who}:[/] ", line)
        if self.is_over:
            self._thanked = self._thanked or who == "person"
            self._told = self._told or who == "robot"

    def say(self, styled: str, text: str) -> None:
        """One line: what is styled by us, then text by others, which is printed as it is."""
        self._console.print(f"[dim]{self.elapsed_s:5.1f} s[/] {styled}", end="")
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)
