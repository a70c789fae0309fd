"""Answers to "why?" and "where are you?", from the records of what was decided and seen."""

import math

from robustnav_msgs_py.records import Decision, SearchPhase, SearchState
from robustnav_msgs_py.values import Pose2D

_DIRECTIONS = ("east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east")


def explain(state: SearchState, decision: Decision | None) -> str:
    """Why the robot does what it does, from its latest decision."""
    if state.phase is SearchPhase.IDLE or not state.target:
        return "I am not looking for anything, so I stand still."
    if state.phase in (SearchPhase.FOUND, SearchPhase.NOT_FOUND, SearchPhase.STOPPED):
        return f"I stand still because the search for the {state.target} has ended: {state.message}."
    if decision is None or decision.episode != state.episode:
        return f"I have only begun to look for the {state.target}; I have not decided anything yet."
    most_likely = (
        f"It is most likely near ({state.best_x_m:.1f}, {state.best_y_m:.1f}) m, with p = {state.p_best:.3f}"
    )
    if decision.action == "dock":
        return f"I drive to where I believe the {state.target} is: {decision.reason}. {most_likely}."
    chosen = f"In step {decision.step} I chose to {_as_verb(decision.action)}"
    worth = dict(zip(decision.actions, decision.values, strict=True))
    tried = {action: value for action, value in worth.items() if not math.isnan(value)}
    best = tried.pop(decision.action, None)
    if best is None:
        return f"{chosen}. {most_likely}."
    ranked = sorted(tried.items(), key=lambda option: option[1], reverse=True)
    others = ", ".join(f"{action} {value:.3g}" for action, value in ranked)
    return (
        f"{chosen}: over {decision.simulations} imagined searches that was worth {best:.3g}"
        + (f" (the others: {others}). " if others else ". ")
        + f"{most_likely}."
    )


def describe_place(pose: Pose2D | None) -> str:
    """Where the robot is, in the map."""
    if pose is None:
        return "I do not know where I am: I get no odometry."
    direction = _DIRECTIONS[round(pose.yaw_rad / (math.tau / len(_DIRECTIONS))) % len(_DIRECTIONS)]
    return f"I am at x = {pose.x_m:.1f} m, y = {pose.y_m:.1f} m in the map, facing {direction}."


def _as_verb(action: str) -> str:
    return f"go {action}" if action in ("forward", "backward") else action
