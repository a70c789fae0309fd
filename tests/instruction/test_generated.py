"""What is said of a generated walk is true of it, by the boxes of the home and the yaws of the walk."""

import math
import re

import numpy as np
import pytest

from robustnav_nodes.benchmarks.generated_instructions import GenerationPlan, survey_home
from robustnav_nodes.instruction.concepts import DIRECTION, OBJECT, ROOM
from robustnav_nodes.instruction.generated.choosing import all_facts
from robustnav_nodes.instruction.generated.facts import Kind
from robustnav_nodes.instruction.generated.frames import FRAMES
from robustnav_nodes.instruction.generated.naming import SAID, plural
from robustnav_nodes.instruction.generated.room_words import WORDS
from robustnav_nodes.instruction.generated.survey import Survey, ToldWalk, instructions_of
from robustnav_nodes.instruction.generated.telling import Clause, Told, tell
from robustnav_nodes.instruction.generated.writers import WRITERS
from robustnav_nodes.instruction.mentions import Mention, concepts_of_name, find_mentions
from robustnav_nodes.instruction.place_model import expected_at
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import wrapped

PLAN = GenerationPlan(seed=4100, homes=2, unseen=1, walks=8, walks_seen=2, writers=4)
SIDES = {"left": 1.0, "right": -1.0, "leftmost": 1.0, "rightmost": -1.0}


@pytest.fixture(scope="module")
def surveys() -> list[Survey]:
    found = [survey_home(PLAN, home) for home in range(3)]
    return [surveyed for surveyed in found if surveyed is not None]


@pytest.fixture(scope="module")
def clauses(surveys: list[Survey]) -> list[tuple[ToldWalk, Clause]]:
    return [
        (walk, clause)
        for surveyed in surveys
        for walks in surveyed.walks.values()
        for walk in walks
        for told in walk.told
        for clause in told.clauses
    ]


RARE = (Kind.CROSS_COUNTED, Kind.CROSS_OUTERMOST, Kind.STOP_OUTERMOST, Kind.STRAIGHT)


@pytest.fixture(scope="module")
def rare_clauses(surveys: list[Survey]) -> list[tuple[ToldWalk, Clause]]:
    """What every writer says of each fact of some kinds, also where none chose to."""
    rng = np.random.default_rng(0)
    return [
        (walk, clause)
        for surveyed in surveys
        for walks in surveyed.walks.values()
        for walk in walks
        for fact in all_facts(walk.surroundings)
        if fact.kind in RARE
        for writer in WRITERS
        for clause in tell([fact], walk.surroundings, writer, rng).clauses
    ]


def mentions(clause: Clause, kind: str) -> list[Mention]:
    return [mention for mention in find_mentions(tokenized(clause.text)) if mention.kind == kind]


def test_objects_that_are_named_are_in_sight(clauses: list[tuple[ToldWalk, Clause]]) -> None:
    checked = 0
    for told, clause in clauses:
        around = told.surroundings
        seen = {
            concept
            for at in range(clause.fact.first, clause.fact.last + 1)
            for thing in around.things(at)
            for concept in concepts_of_name(thing.name)
        }
        # A door that is walked through cannot be overlooked, also where most of it is out of sight.
        if any(thing.joins is not None for thing in clause.fact.things):
            seen.add("door")
        for mention in mentions(clause, OBJECT):
            assert mention.concept in seen, (clause.text, clause.fact)
            checked += 1
    assert checked > 50


def test_rooms_that_are_named_are_those_of_the_walk(clauses: list[tuple[ToldWalk, Clause]]) -> None:
    for told, clause in clauses:
        walk, dwelling = told.walk, told.surroundings.dwelling
        near = set(walk.rooms[clause.fact.first : clause.fact.last + 1])
        for crossing in walk.crossings:
            if clause.fact.first <= crossing.after <= clause.fact.last:
                near |= {crossing.left, crossing.entered}
        if clause.fact.kind is Kind.STOP_OUTSIDE:
            near = set(clause.fact.rooms)
            assert walk.rooms[-1] not in near
            assert clause.fact.things[0].away_m(*walk.xy_m[-1].tolist()) < 1.6
        said = {form for room in near for form in WORDS[dwelling.room(room).kind].said}
        concepts = {m.concept for form in said for m in find_mentions(form.split()) if m.kind == ROOM}
        for mention in mentions(clause, ROOM):
            assert mention.concept in concepts, (clause.text, near)


def test_sides_agree_with_the_geometry(clauses: list[tuple[ToldWalk, Clause]]) -> None:
    """A turn by the sum of the yaws, a thing by where it lies, seen from some place of the stretch."""
    checked = 0
    for told, clause in clauses:
        walk, fact = told.walk, clause.fact
        signs = {SIDES[m.concept] for m in mentions(clause, DIRECTION) if m.concept in SIDES}
        if fact.kind is Kind.PASS_BETWEEN or not signs:
            continue
        (sign,) = signs
        checked += 1
        if fact.kind.name.startswith(("TURN", "START_TURN", "START_SLIGHTLY", "START_FACING", "AROUND")):
            first = fact.first + (fact.kind is Kind.AROUND)
            last = fact.first if fact.kind.name.startswith("START") else fact.last
            turned = sum(walk.turn_rad(at) for at in range(first, last + 1))
            assert turned * sign > math.radians(15.0), clause.text
        elif fact.kind is Kind.CROSS_TURNING:
            assert walk.turn_rad(fact.first) * sign > 0.0, clause.text
        else:
            x, y, _ = fact.things[0].centre_m
            bearings = [
                wrapped(math.atan2(y - walk.xy_m[at, 1], x - walk.xy_m[at, 0]) - yaw)
                for at in range(fact.first, fact.last + 1)
                for yaw in (walk.yaw_in_rad[at], walk.yaw_out_rad[at])
            ]
            if fact.kind in (Kind.CROSS_OUTERMOST, Kind.STOP_OUTERMOST):
                others = [t for t in told.surroundings.things(fact.first) if t.name == fact.things[0].name]
                assert len(others) > 1, clause.text
            else:
                assert any(bearing * sign > 0.0 for bearing in bearings), clause.text
    assert checked > 50


def test_the_outermost_lies_farther_to_its_side_than_all_others(
    rare_clauses: list[tuple[ToldWalk, Clause]],
) -> None:
    """Of the doors that somebody faces on the way to one, and of the things alike where a walk ends."""
    checked = 0
    for told, clause in rare_clauses:
        sides = [m.concept for m in mentions(clause, DIRECTION) if m.concept.endswith("most")]
        if not sides:
            continue
        walk, fact = told.walk, clause.fact
        at, own = fact.first, fact.things[0]
        yaw = walk.yaw_in_rad[at] if own.joins else walk.yaw_out_rad[at]
        behind = {crossing.door for crossing in walk.crossings if crossing.after < at}
        others = [
            thing
            for thing in told.surroundings.things(at)
            if thing != own
            and thing.name == own.name
            and (thing.room == own.room if own.joins is None else fact.rooms[0] in (thing.joins or ()))
            and thing not in behind
            and abs(walk.bearing_rad(at, thing, yaw)) <= math.radians(100.0)
        ]
        bearings = [walk.bearing_rad(at, thing, yaw) * SIDES[sides[0]] for thing in (own, *others)]
        assert others, clause.text
        assert max(bearings[1:]) < bearings[0], clause.text
        checked += 1
    assert checked > 20


def test_the_nth_door_is_the_nth_at_its_side(rare_clauses: list[tuple[ToldWalk, Clause]]) -> None:
    """Of the doors of the room that are left behind at that side, by their order along the way."""
    ordinals = ("first", "second", "third", "fourth", "fifth")
    checked = 0
    for told, clause in rare_clauses:
        walk, fact = told.walk, clause.fact
        said = [word for word in tokenized(clause.text) if word in (*ordinals, "last")]
        if fact.kind is not Kind.CROSS_COUNTED or not said:
            continue
        (sign,) = {SIDES[m.concept] for m in mentions(clause, DIRECTION) if m.concept in SIDES}
        x, y = walk.xy_m[fact.first].tolist()
        cos, sin = math.cos(walk.yaw_out_rad[fact.first]), math.sin(walk.yaw_out_rad[fact.first])
        came_by = [c.door for c in walk.crossings if c.after < fact.first]
        along = []
        for door in told.surroundings.dwelling.doors:
            if fact.rooms[0] not in (door.joins or ()) or door in came_by[-1:]:
                continue
            dx, dy = door.centre_m[0] - x, door.centre_m[1] - y
            width, depth = (door.high_m[k] - door.low_m[k] for k in (0, 1))
            is_beside = abs(cos if width > depth else sin) > 0.8 and (cos * dy - sin * dx) * sign > 0.4
            if is_beside and cos * dx + sin * dy > 0.2:
                along.append((cos * dx + sin * dy, door.number))
        order = [number for _, number in sorted(along)]
        expected = len(order) if said[0] == "last" else ordinals.index(said[0]) + 1
        assert order.index(fact.things[0].number) + 1 == expected, clause.text
        checked += 1
    assert checked > 20


def test_distances_are_those_of_a_straight_way(rare_clauses: list[tuple[ToldWalk, Clause]]) -> None:
    """To half a metre, or half of the five feet that people round to."""
    numbers = ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"]
    checked = 0
    for told, clause in rare_clauses:
        found = re.search(r"(\w+) (meter|feet)", clause.text)
        if found is None:
            continue
        walk, fact = told.walk, clause.fact
        said = numbers.index(found[1]) if found[1] in numbers else int(found[1])
        unit_m, step = (1.0, 1) if found[2] == "meter" else (0.3048, 5)
        walked_m = float(np.linalg.norm(np.diff(walk.xy_m[fact.first : fact.last + 1], axis=0), axis=1).sum())
        assert abs(said * unit_m - walked_m) <= 0.51 * step * unit_m, clause.text
        turns = [abs(walk.turn_rad(at)) for at in range(fact.first + 1, fact.last)]
        assert max(turns, default=0.0) < math.radians(25.0), clause.text
        checked += 1
    assert checked > 20


def test_the_other_directions_agree_too(clauses: list[tuple[ToldWalk, Clause]]) -> None:
    for told, clause in clauses:
        said = {mention.concept for mention in mentions(clause, DIRECTION)}
        walk, first = told.walk, clause.fact.first
        assert not said & {"up", "down"}, clause.text
        if "backward" in said or "back" in said:
            assert abs(walk.turn_rad(0)) > math.radians(135.0), clause.text
        if clause.fact.kind is Kind.START_FORWARD:
            assert abs(walk.turn_rad(first)) < math.radians(21.0), clause.text
        if "inside" in said or "outside" in said:
            assert ("inside" in said) == (clause.fact.rooms[0] == walk.rooms[-1]), clause.text
        if said & {"into", "out of"} and not clause.fact.kind.name.startswith("STOP"):
            assert walk.crossings, clause.text


def test_walks_keep_clear_of_things(surveys: list[Survey]) -> None:
    for surveyed in surveys:
        blocked = surveyed.dwelling.footprints()
        for walks in surveyed.walks.values():
            for told in walks:
                shares = np.linspace(0.0, told.walk.length_m, 200)
                xy = np.stack([np.interp(shares, told.walk.so_far_m, told.walk.xy_m[:, k]) for k in (0, 1)])
                inside = (xy.T[:, None] > blocked[:, :2]) & (xy.T[:, None] < blocked[:, 2:])
                assert not inside.all(axis=2).any()


def test_walks_of_splits_differ(surveys: list[Survey]) -> None:
    ends = {
        split: {(told.walk.places[0], told.walk.places[-1]) for told in walks}
        for split, walks in surveys[0].walks.items()
    }
    assert ends["train"]
    assert ends["val_seen"]
    assert not ends["train"] & ends["val_seen"]
    assert list(surveys[2].walks) == ["val_unseen"]


def test_length_and_turns_of_instructions(surveys: list[Survey]) -> None:
    said = [
        one for surveyed in surveys for split in surveyed.walks for one in instructions_of(surveyed, split)
    ]
    lengths = np.array([len(one.tokens) for one in said])
    assert 20.0 < lengths.mean() < 40.0
    assert (lengths >= 10).mean() > 0.9
    assert {one.group for one in said} == {surveyed.dwelling.name for surveyed in surveys}


def test_the_same_seed_says_the_same(surveys: list[Survey]) -> None:
    again = survey_home(PLAN, 2)
    assert again is not None
    assert instructions_of(again, "val_unseen") == instructions_of(surveys[2], "val_unseen")


def test_every_word_is_understood() -> None:
    """Each noun is a mention of the concepts that its detector's name stands for, in both numbers."""
    for name, nouns in SAID.items():
        for noun in nouns:
            for form in (noun, plural(noun)):
                named = {m.concept for m in find_mentions(form.split())}
                assert named <= concepts_of_name(name), (name, form)


def test_frames_say_nothing_by_accident() -> None:
    """With nothing filled in, no frame names a room, and an object only where it is a door."""
    for kind, frames in FRAMES.items():
        for frame in frames:
            said = tokenized(frame.replace("|", " . ").replace("(", " ").replace(")", " "))
            for mention in find_mentions(said):
                assert mention.kind != ROOM, (kind, frame)
                assert mention.kind != OBJECT or mention.concept == "door", (kind, frame)


def test_mentions_are_expected_where_the_walk_is_when_they_are_said(surveys: list[Survey]) -> None:
    """Nearer to the middle of the stretch that their clause speaks of than by their share of the text."""
    expected, by_share = [], []
    for surveyed in surveys:
        for walks in surveyed.walks.values():
            for walk in walks:
                for told in walk.told:
                    tokens = tokenized(told.text)
                    mentions = find_mentions(tokens)
                    middles = _middles_of(told, tokens, len(walk.walk) - 1)
                    for mention, along in zip(mentions, expected_at(tokens, mentions), strict=True):
                        middle = middles[mention.start]
                        if middle is not None:
                            expected.append(along - middle)
                            centre = mention.start + (mention.length - 1) / 2.0
                            by_share.append(centre / (len(tokens) - 1) - middle)
    assert len(expected) > 300
    assert np.square(expected).mean() < 0.9 * np.square(by_share).mean()
    assert abs(np.mean(expected)) < abs(np.mean(by_share))


def _middles_of(told: Told, tokens: tuple[str, ...], last: int) -> list[float | None]:
    """How far along the walk the middle of each token's clause is; None where it is in none."""
    middles: list[float | None] = [None] * len(tokens)
    at = 0
    for clause in told.clauses:
        words = tokenized(clause.text)
        while at < len(tokens) and tokens[at : at + len(words)] != words:
            at += 1
        for k in range(at, min(at + len(words), len(tokens))):
            middles[k] = (clause.fact.first + clause.fact.last) / 2.0 / last
        at += len(words)
    return middles
