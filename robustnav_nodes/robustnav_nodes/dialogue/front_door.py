"""The front door: takes what the person says, decides what the robot searches for and what it answers."""

from dataclasses import dataclass, replace

from robustnav_msgs_py.records import Decision, DialogueState, SearchPhase, SearchState
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.dialogue.class_names import listed, matching_class
from robustnav_nodes.dialogue.explanations import describe_place, explain
from robustnav_nodes.dialogue.parameters import DialogueParameters
from robustnav_nodes.dialogue.requests import Request, RequestKind, UnreadableLineError, read_line

SHOWN_CHARS = 120
UNDER_WAY = (SearchPhase.SEARCHING, SearchPhase.DOCKING)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reaction:
    """What follows from a line: an answer, and a target for the search ("" stops it, None leaves it).

    is_right: of the class `found`, whether the person says that the find was right; None: nothing was said.
    """

    answer: str
    target: str | None = None
    found: str = ""
    is_right: bool | None = None


class FrontDoor:
    """Keeps what the dialogue knows. Owned by the dialogue node, used in its executor thread only."""

    def __init__(self, parameters: DialogueParameters) -> None:
        self._parameters = parameters
        self._names: tuple[str, ...] = ()
        self._search = SearchState()
        self._decision: Decision | None = None
        self._state = DialogueState()
        self._asked_for = ""  # the target of a search that has not begun yet
        self._found = ""  # what was found last, until the person says whether it is right

    @property
    def state(self) -> DialogueState:
        """What the dialogue is about."""
        return self._state

    def hear_names(self, names: tuple[str, ...]) -> None:
        """The classes that the detector knows."""
        self._names = names

    def hear_decision(self, decision: Decision) -> None:
        """The planner decided."""
        self._decision = decision

    def hear_search(self, search: SearchState) -> Reaction | None:
        """How the search stands; returns what to tell the person, and the end of the target with the search.

        The target does not outlive its search: it is latched, and a node that starts later must not begin
        to look for what was found already. A search that begins without having been asked for here (the
        dialogue was started again, or the planner's service was called) is taken over, and its target said to
        all. One that was asked for is not: its first word may come after the person has said "stop".
        """
        before, self._search = self._search, search
        if search.phase in UNDER_WAY and search.episode != before.episode:
            asked_for, self._asked_for = self._asked_for, ""
            if search.target not in (asked_for, self._state.target):
                self._state = replace(self._state, target=search.target)
                return Reaction(answer="", target=search.target)
        same = (search.episode, search.phase) == (before.episode, before.phase)
        if same or search.target != self._state.target or not search.target:
            return None
        if search.phase is SearchPhase.FOUND:
            self._found = search.target
            return self._ended(
                f"I found the {search.target}: it is near x = {search.best_x_m:.1f} m, "
                f"y = {search.best_y_m:.1f} m, and I am looking at it. "
                f"It took {search.step} steps and {search.path_length_m:.1f} m."
            )
        if search.phase is SearchPhase.NOT_FOUND:
            return self._ended(f"I did not find the {search.target}: {search.message}.")
        if search.phase is SearchPhase.STOPPED:
            return self._ended(f"I stopped looking for the {search.target}: {search.message}.")
        if search.phase is SearchPhase.DOCKING:
            return Reaction(answer=self._said(f"I think I see the {search.target}; I am driving there."))
        return None

    def hear(self, line: str, robot: Pose2D | None) -> Reaction:
        """One line of the person; `robot` is where the robot is, if known."""
        shown = line if len(line) <= SHOWN_CHARS else line[: SHOWN_CHARS - 1] + "…"
        try:
            reaction = self._react(read_line(line, self._parameters.max_line_chars), robot)
        except UnreadableLineError as error:
            reaction = Reaction(answer=str(error))
        self._asked_for = reaction.target or self._asked_for
        target = self._state.target if reaction.target is None else reaction.target
        self._state = replace(
            self._state,
            target=target,
            lines_heard=self._state.lines_heard + 1,
            last_heard=shown,
            last_said=reaction.answer,
        )
        return reaction

    def _react(self, request: Request, robot: Pose2D | None) -> Reaction:
        match request.kind:
            case RequestKind.FIND:
                return self._find(request.thing)
            case RequestKind.STOP:
                return Reaction(answer="I have stopped.", target="")
            case RequestKind.WHERE:
                return Reaction(answer=describe_place(robot))
            case RequestKind.WHY:
                return Reaction(answer=explain(self._search, self._decision))
            case RequestKind.THANKS:
                return self._judged("You are welcome.", is_right=True)
            case RequestKind.RIGHT:
                return self._judged("Good.", is_right=True)
            case RequestKind.WRONG:
                return self._wrong()
            case RequestKind.GREETING | RequestKind.HELP:
                return Reaction(answer=f"Hello. {self._offer()}")
            case RequestKind.UNKNOWN:
                if request.thing and matching_class(request.thing, self._names) is not None:
                    return self._find(request.thing)
                return Reaction(answer=f"I did not understand that. {self._offer()}")

    def _judged(self, answer: str, *, is_right: bool) -> Reaction:
        """The person is content with the last find, or not; that counts once."""
        found, self._found = self._found, ""
        return Reaction(answer=answer, found=found, is_right=is_right if found else None)

    def _wrong(self) -> Reaction:
        if not self._found:
            return Reaction(answer=f"I have not found anything that could be wrong. {self._offer()}")
        return self._judged(
            f"I am sorry. I trust my eyes less with the {self._found} now; ask me again, and I look anew.",
            is_right=False,
        )

    def _find(self, thing: str) -> Reaction:
        if not self._names:
            return Reaction(
                answer="I cannot look for anything yet: my detector has not started. Ask me again soon."
            )
        name = matching_class(thing, self._names)
        if name is None:
            return Reaction(answer=f"I do not know what {_quoted(thing)} looks like. {self._offer()}")
        if self._search.phase in UNDER_WAY and name == self._search.target == self._state.target:
            return Reaction(answer=f"I am still looking for the {name}.")
        self._found = ""
        return Reaction(answer=f"I am looking for the {name}.", target=name)

    def _offer(self) -> str:
        if not self._names:
            return "Ask me to find something, such as: find the mug."
        names = listed(self._names, self._parameters.max_names)
        return f"I can find: {names}. Say, for example: find the {self._names[0]}."

    def _ended(self, line: str) -> Reaction:
        self._state = replace(self._state, target="")
        return Reaction(answer=self._said(line), target="")

    def _said(self, line: str) -> str:
        self._state = replace(self._state, last_said=line)
        return line


def _quoted(thing: str) -> str:
    return repr(thing if len(thing) <= SHOWN_CHARS else thing[: SHOWN_CHARS - 1] + "…")
