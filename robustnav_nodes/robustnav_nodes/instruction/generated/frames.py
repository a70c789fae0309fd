"""The sentences: for each kind of fact the ways to say it. Any thing, room or side fits into each.

`(a|b|)` is a choice, made by chance; `{thing}`, `{other}`, `{room}`, `{entered}`, `{side}`, `{count}` and
`{distance}` are filled in. `{the_side}` is "the left" or "your left", `{sidemost}` "leftmost", `{noun}` the
thing without an article. A frame that begins with "=" is a sentence of its own, all others can be joined.
Words that would be taken for a direction but say nothing of the way ("right before", "down the hall",
"steps") are kept out.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from robustnav_nodes.instruction.generated.facts import Kind

_WALK = "(walk|walk|go|go|head|move|proceed)"
_STOP = "(stop|stop|wait|stand|stop and wait|come to a stop|halt)"

FRAMES: Mapping[Kind, tuple[str, ...]] = MappingProxyType(
    {
        Kind.START_TURN: (
            "turn {side}",
            "turn to {the_side}",
            "make a {side} turn",
            "(rotate|pivot) to {the_side}",
            "begin by turning {side}",
            "(start|begin) with a {side} turn",
            "turn {side} from where you (are|stand)",
        ),
        Kind.START_SLIGHTLY: (
            "turn slightly {side}",
            "turn (a little|a bit) to {the_side}",
            "(bear|veer) slightly {side}",
            "make a slight {side}",
        ),
        Kind.START_AROUND: (
            "turn around",
            "turn (all the way|completely) around",
            "turn around to face the other way",
            "do a 180",
            "make a u-turn",
            "spin around",
        ),
        Kind.START_FACING: (
            "with {thing} in front of you, turn {side}",
            "facing {thing}, turn {side}",
            "when facing {thing}, turn to {the_side}",
            "turn {side}, away from {thing}",
            "=you are facing {thing}. turn {side}",
            "=start out facing {thing} and turn {side}",
        ),
        Kind.START_BESIDE: (
            "with {thing} on {the_side}, " + _WALK + " (straight|forward|ahead)",
            "starting with {thing} to {the_side}, go (straight|forward|ahead)",
            _WALK + " forward, keeping {thing} on {the_side}",
            "=you start with {thing} on {the_side}. (go|walk) (straight ahead|forward)",
        ),
        Kind.START_FORWARD: (
            _WALK + " (straight|forward|ahead)",
            "(step|move|go) forward",
            "(begin|start) straight ahead",
            "start by (going|walking) (forward|straight)",
            "go straight (ahead|from where you are)",
        ),
        Kind.START_BACK: (
            "(go|walk|head) back to {thing}",
            "(go|walk|head|move) back (toward|towards) {thing} behind you",
            "turn and (walk|go) back toward {thing}",
            "turn around and (go|walk|head) toward {thing}",
        ),
        Kind.START_BACKWARD: (
            "(go|move|walk|head) backward, away from {thing}",
            "(go|walk|move) backward from {thing}",
            "leave {thing} behind you and (go|head) backward",
            "with {thing} in front of you, (go|walk|move) backward",
            "turn your back to {thing} and (go|walk) the other way",
            "turn around so that {thing} is behind you",
        ),
        Kind.TURN: (
            "turn {side}",
            "turn {side}",
            "(make|take|hang) a {side}",
            "make a {side} turn",
            "(go|head) {side}",
            "turn to {the_side}",
            "take a {side} turn",
        ),
        Kind.TURN_SLIGHTLY: (
            "turn slightly {side}",
            "(bear|veer|keep) slightly {side}",
            "(bear|veer) {side}",
            "make a slight {side}",
            "(turn|go) a (little|bit) to {the_side}",
            "veer slightly to {the_side}",
        ),
        Kind.TURN_SHARPLY: (
            "turn sharply {side}",
            "make a (sharp|hard) {side}",
            "take a sharp {side}",
            "make a (hard|sharp) {side} turn",
        ),
        Kind.TURN_AT: (
            "turn {side} at {thing}",
            "(make|take|hang) a {side} at {thing}",
            "turn {side} when you (reach|get to|come to) {thing}",
            "at {thing}, turn {side}",
            "when you (reach|get to|are next to) {thing}, (turn|go) {side}",
            "go {side} by {thing}",
            "once you are at {thing}, make a {side}",
        ),
        Kind.TURN_TOWARDS: (
            "turn {side} (toward|towards) {thing}",
            "turn {side} to face {thing}",
            "(turn|go) {side}, (heading|walking) (toward|towards) {thing}",
            "make a {side} (toward|towards) {thing}",
            "turn {side} and (walk|head|go) to {thing}",
        ),
        Kind.CROSS: (
            "(exit|leave) {room}",
            "(walk|go|head|step) out of {room}",
            "(enter|go into|walk into|step into|head into) {entered}",
            "(walk|go|head|step) out of {room}",
            "(exit|leave|go out of) {room}",
            "(leave|get out of|walk out of) {room}",
            "(walk|go|head) into {entered}",
            "(enter|move on to|go on to) {entered}",
            "(walk|go) out of {room} (and into|into) {entered}",
            "(exit|leave) {room} and (enter|go into) {entered}",
            "go through (the door|the doorway|the open door)",
            "(walk|go|pass|head) through the (door|doorway) into {entered}",
            "go out of {room} through the (door|doorway)",
            "go from {room} (to|into) {entered}",
            "(continue|proceed) (to|into) {entered}",
            "make your way (to|over to|into) {entered}",
            "move from {room} (to|into) {entered}",
            "(enter|step into) {entered} through the (door|doorway)",
        ),
        Kind.CROSS_ASIDE: (
            "(go|walk|head) through the (door|doorway) on {the_side}",
            "take the (door|doorway) on {the_side}",
            "(enter|go into) {entered} on {the_side}",
            "(enter|go to) {entered}, which is on {the_side}",
            "(go|walk) out of {room} to {the_side}",
            "leave {room} on {the_side}",
            "(exit|leave) {room} through the door on {the_side}",
            "(go|walk|step) into {entered} on {the_side}",
            "use the (door|doorway) on {the_side} to (leave|exit) {room}",
            "go through the (door|doorway) to {the_side} into {entered}",
        ),
        Kind.CROSS_TURNING: (
            "turn {side} into {entered}",
            "turn {side} and (enter|go into|walk into) {entered}",
            "(make|take) a {side} into {entered}",
            "turn {side} through the (door|doorway)",
            "turn {side} and (go|walk) through the (door|doorway)",
            "turn {side} (out of|leaving) {room}",
            "(turn|go) {side} out of {room}",
            "(turn|go) {side} to (exit|leave) {room}",
        ),
        Kind.CROSS_COUNTED: (
            "(go|walk) through the {count} (door|doorway) on {the_side}",
            "take the {count} (door|doorway) on {the_side}",
            "(enter|go into|step into) the {count} (door|doorway|room) on {the_side}",
            "turn into the {count} (door|doorway) on {the_side}",
            "(walk|go) into {entered} through the {count} door on {the_side}",
        ),
        Kind.CROSS_OUTERMOST: (
            "(go|walk) through the {sidemost} (door|doorway)",
            "take the {sidemost} door",
            "(enter|go into) {entered} through the {sidemost} (door|doorway)",
            "use the {sidemost} door to (leave|exit) {room}",
        ),
        Kind.THROUGH: (
            _WALK + " through {room}",
            "(walk|go|head) across {room}",
            "cross {room}",
            "(walk|go) (all the way|straight) through {room}",
            "go to the other (side|end) of {room}",
            "continue through {room}",
            "pass through {room}",
        ),
        Kind.STRAIGHT: (
            "(go|walk|continue|keep going) straight",
            "(walk|go|head|continue) straight ahead",
            "(walk|go|move|continue) forward",
            "keep (going|walking) (straight|forward|ahead)",
            "(walk|go) straight for (about|around|) {distance}",
            "(walk|go|move) forward (about|roughly|) {distance}",
            "continue (forward|straight|ahead) for {distance}",
        ),
        Kind.PASS: (
            "(walk|go|continue|head) past {thing}",
            "pass {thing}",
            "(walk|go|continue) past {thing} on {the_side}",
            "pass {thing} on {the_side}",
            "go (by|past) {thing} that is on {the_side}",
            "(walk|go) (by|past) {thing}",
            "keep {thing} on {the_side}",
            "(walk|go) with {thing} on {the_side}",
            "(walk|go) past {thing} to {the_side}",
            "pass by {thing} on {the_side}",
        ),
        Kind.PASS_BETWEEN: (
            "(walk|go|pass) between {thing} and {other}",
            "(walk|go) through the gap between {thing} and {other}",
            "pass {thing} on {the_left} and {other} on {the_right}",
        ),
        Kind.AROUND: (
            "(walk|go|head|move) around {thing}",
            "(walk|go) around {thing}, turning {side}",
            "make your way around {thing}",
        ),
        Kind.TOWARDS: (
            _WALK + " (toward|towards) {thing}",
            "(walk|go|head) (straight|directly) (to|toward|towards) {thing}",
            "(walk|go|head) in the direction of {thing}",
            "make your way (toward|over to) {thing}",
            "(aim|head|head) for {thing}",
        ),
        Kind.UNTIL: (
            "(walk|go|continue|keep going) until you (reach|get to|come to) {thing}",
            "(walk|go|head) (over to|to) {thing}",
        ),
        Kind.AHEAD_TO: (
            "(walk|go) forward until you are (next to|by|at) {thing}",
            "continue (straight|forward|ahead) (to|until you reach) {thing}",
            "(walk|go|head|move) (forward|straight ahead) to {thing}",
            "keep going (straight|forward) (until you get to|to) {thing}",
        ),
        Kind.SEE: (
            "=(you will|you'll|you should) see {thing} on {the_side}",
            "=you (will pass|go past|come past) {thing} on {the_side}",
            "=look for {thing} on {the_side}",
            "=notice {thing} to {the_side}",
        ),
        Kind.STOP_NEAR: (
            _STOP + " (next to|near|by|beside|close to|by|near) {thing}",
            _STOP + " (at|next to|by) {thing}",
            "(stop|wait) when you (reach|get to|are next to) {thing}",
            "stop once you are (near|by|next to) {thing}",
        ),
        Kind.STOP_FACING: (
            _STOP + " in front of {thing}",
            _STOP + " facing {thing}",
            "(stop|wait) (just before|before you get to|before) {thing}",
            "stop when {thing} is in front of you",
        ),
        Kind.STOP_BESIDE: (
            _STOP + " with {thing} on {the_side}",
            _STOP + " (next to|by|beside) {thing} on {the_side}",
            "stop when {thing} is (on|to) {the_side}",
            "(stop|wait) once you have {thing} on {the_side}",
        ),
        Kind.STOP_BETWEEN: (
            _STOP + " between {thing} and {other}",
            "(stop|wait) in the space between {thing} and {other}",
        ),
        Kind.STOP_OUTERMOST: (
            _STOP + " (by|next to|near|at) the {sidemost} {noun}",
            "go to the {sidemost} {noun} and (stop|wait|stop there)",
        ),
        Kind.STOP_IN_DOOR: (
            _STOP + " in the (doorway|door|doorway)",
            _STOP + " at the (door|doorway)",
            "stop when you (reach|get to) the doorway",
        ),
        Kind.STOP_IN: (
            _STOP + " in {room}",
            _STOP + " there in {room}",
            "(stop|wait) when you are in {room}",
            "stop in {room}. (this is it|that is the spot|you have arrived)",
            "wait in {room}",
        ),
        Kind.STOP_INSIDE: (
            _STOP + " (just|) inside {room}",
            _STOP + " (just|) inside the (door|doorway)",
            "stop (as soon as|once|when) you are inside {room}",
            "(stop|wait) inside {room}, (near|by) the (door|doorway)",
        ),
        Kind.STOP_OUTSIDE: (
            _STOP + " (just|) outside {room}",
            _STOP + " (just|) outside the (door|doorway) to {room}",
            "(stop|wait) outside {room}, (near|by) the (door|doorway)",
            "stop (as soon as|once|when) you are outside {room}",
        ),
    }
)


def chosen(frame: str, rng: np.random.Generator) -> str:
    """The frame with one way of each choice; slots are left as they are."""
    said, rest = "", frame
    while "(" in rest:
        before, _, rest = rest.partition("(")
        choice, _, rest = rest.partition(")")
        options = choice.split("|")
        said += before + options[int(rng.integers(len(options)))]
    return " ".join((said + rest).split()).replace(" ,", ",")
