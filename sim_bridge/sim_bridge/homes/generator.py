"""Homes from seeds: the same seed and settings give the same home, on every machine."""

import dataclasses
import math

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.arrangement import arrange
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furnishing import furnish
from sim_bridge.homes.home import Home
from sim_bridge.homes.objects import LABELS
from sim_bridge.homes.rooms import ROOM_PLANS, lay_out
from sim_bridge.homes.scene_check import check_home
from sim_bridge.robot.obstacles import ClearanceGrid

DRAWS = 60
OBJECT_COUNT = (14, 20)
MIN_OBJECTS, MAX_OBJECTS = 12, 24
START_CLEARANCE_M = 0.40
START_HEADINGS = 12


def generate_home(seed: int, *, rooms: int | None = None, objects: int | None = None) -> Home:
    """A furnished home with `rooms` (3..6) rooms and `objects` (12..24) objects; drawn where None.

    Raises BadSceneError where the numbers are out of range or no draw of the seed holds together.
    """
    if seed < 0:
        raise BadSceneError(f"a seed must not be negative, not {seed!r}")
    if objects is not None and not MIN_OBJECTS <= objects <= MAX_OBJECTS:
        raise BadSceneError(f"a home holds {MIN_OBJECTS}..{MAX_OBJECTS} objects, not {objects!r}")
    if rooms is not None and rooms not in ROOM_PLANS:
        raise BadSceneError(f"a home has {min(ROOM_PLANS)}..{max(ROOM_PLANS)} rooms, not {rooms!r}")
    rng = np.random.default_rng(seed)
    room_count = rooms if rooms is not None else int(rng.choice(list(ROOM_PLANS)))
    object_count = objects if objects is not None else int(rng.integers(OBJECT_COUNT[0], OBJECT_COUNT[1] + 1))
    last = ""
    for _ in range(DRAWS):
        try:
            return _draw(rng, seed, room_count, object_count)
        except BadSceneError as problem:
            last = str(problem)
    raise BadSceneError(
        f"no home of {room_count} rooms and {object_count} objects came out of seed {seed} in {DRAWS} draws; "
        f"the last failed because {last}. Ask for fewer objects or another seed."
    )


def _draw(rng: np.random.Generator, seed: int, room_count: int, object_count: int) -> Home:
    layout = lay_out(rng, room_count)
    furniture = furnish(rng, layout, RESOLUTION_M)
    home = Home(
        name=f"home-{seed}",
        seed=seed,
        bounds=layout.bounds,
        rooms=layout.rooms,
        doors=layout.doors,
        walls=layout.walls,
        furniture=furniture,
        objects=arrange(rng, furniture, object_count),
        labels=LABELS,
        start=Pose2D(x_m=0.0, y_m=0.0),
    )
    home = _with_start(rng, home)
    check_home(home)
    return home


def _with_start(rng: np.random.Generator, home: Home) -> Home:
    grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(home.obstacles())
    rows, columns = np.nonzero(grid.cells_m >= START_CLEARANCE_M)
    if not len(rows):
        raise BadSceneError(f"the robot has nowhere to start {START_CLEARANCE_M} m away from everything")
    at = int(rng.integers(len(rows)))
    heading = int(rng.integers(START_HEADINGS)) * math.tau / START_HEADINGS
    start = Pose2D(
        x_m=round(float(grid.x_m[columns[at]]), 6),
        y_m=round(float(grid.y_m[rows[at]]), 6),
        yaw_rad=math.remainder(heading, math.tau),
    )
    return dataclasses.replace(home, start=start)
