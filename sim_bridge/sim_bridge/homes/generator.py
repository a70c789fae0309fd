"""Homes from seeds: the same seed and settings give the same home, on every machine."""

import math

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.build import build_home
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furniture.catalogue import build_furniture
from sim_bridge.homes.furniture.furnishing import furnish
from sim_bridge.homes.home import Furniture, Home
from sim_bridge.homes.objects.arrangement import arrange
from sim_bridge.homes.objects.catalogue import object_class
from sim_bridge.homes.obstacles import ClearanceGrid
from sim_bridge.homes.rooms.floor_layout import lay_out
from sim_bridge.homes.rooms.room_programmes import (
    MAX_ROOMS,
    MIN_ROOMS,
    Difficulty,
    draw_programme,
    room_count_of,
)
from sim_bridge.homes.rooms.walls import Shell, build_shell
from sim_bridge.homes.scene import Scene
from sim_bridge.homes.scene_check import check_passages

DRAWS = 60
# Besides the first ones, so many for each room.
FIRST_OBJECTS, OBJECTS_PER_ROOM = 4, (5, 7)
MIN_OBJECTS, MAX_OBJECTS = 4, 80
START_CLEARANCE_M = 0.40
START_HEADINGS = 12
# Coordinates are rounded to what a scene file keeps.
DECIMALS = 6


def generate_home(
    seed: int,
    *,
    difficulty: Difficulty = Difficulty.MEDIUM,
    rooms: int | None = None,
    objects: int | None = None,
    look_alikes: str = "",
) -> Home:
    """The home that `generate_scene` describes, built."""
    return build_home(
        generate_scene(seed, difficulty=difficulty, rooms=rooms, objects=objects, look_alikes=look_alikes)
    )


def generate_scene(
    seed: int,
    *,
    difficulty: Difficulty = Difficulty.MEDIUM,
    rooms: int | None = None,
    objects: int | None = None,
    look_alikes: str = "",
) -> Scene:
    """A furnished home: easy ones have 1 room, medium 3 or 4, hard 6 to 10, unless `rooms` says how many.

    `objects`: how many small objects (4..80); None: nine to eleven in one room, five to seven for each more.
    `look_alikes`: a class of which the home holds at least three. Raises BadSceneError where the numbers are
    out of range, the class is unknown, or no draw of the seed holds together.
    """
    if seed < 0:
        raise BadSceneError(f"a seed must not be negative, not {seed!r}")
    if objects is not None and not MIN_OBJECTS <= objects <= MAX_OBJECTS:
        raise BadSceneError(f"a home holds {MIN_OBJECTS}..{MAX_OBJECTS} objects, not {objects!r}")
    if rooms is not None and not MIN_ROOMS <= rooms <= MAX_ROOMS:
        raise BadSceneError(f"a home has {MIN_ROOMS}..{MAX_ROOMS} rooms, not {rooms!r}")
    if look_alikes:
        object_class(look_alikes)  # unknown in every draw
    rng = np.random.default_rng(seed)
    room_count = rooms or room_count_of(rng, difficulty)
    low, high = (FIRST_OBJECTS + room_count * number for number in OBJECTS_PER_ROOM)
    object_count = objects or min(MAX_OBJECTS, int(rng.integers(low, high + 1)))
    last = ""
    for _ in range(DRAWS):
        try:
            return _draw(rng, seed, room_count, object_count, look_alikes)
        except BadSceneError as problem:
            last = str(problem)
    raise BadSceneError(
        f"no home of {room_count} rooms and {object_count} objects came out of seed {seed} in {DRAWS} draws; "
        f"the last failed because {last}. Ask for fewer objects or another seed."
    )


def _draw(rng: np.random.Generator, seed: int, room_count: int, object_count: int, look_alikes: str) -> Scene:
    layout = lay_out(rng, draw_programme(rng, room_count))
    shell = build_shell(layout.rooms, layout.doors, layout.windows)
    pieces = furnish(rng, shell)
    furniture = tuple(build_furniture(piece) for piece in pieces)
    scene = Scene(
        name=f"home-{seed}",
        seed=seed,
        rooms=layout.rooms,
        doors=layout.doors,
        windows=layout.windows,
        furniture=pieces,
        objects=arrange(rng, furniture, object_count, look_alikes, walls=shell.walls, windows=shell.windows),
        start=_start(rng, shell, furniture),
    )
    check_passages(build_home(scene))
    return scene


def _start(rng: np.random.Generator, shell: Shell, furniture: tuple[Furniture, ...]) -> Pose2D:
    obstacles = [wall.base for wall in shell.walls if wall.z_min_m == 0.0]
    obstacles += [piece.footprint for piece in furniture]
    grid = ClearanceGrid(shell.bounds, RESOLUTION_M).with_rects(obstacles)
    rows, columns = np.nonzero(grid.cells_m >= START_CLEARANCE_M)
    if not len(rows):
        raise BadSceneError(f"the robot has nowhere to start {START_CLEARANCE_M} m away from everything")
    at = int(rng.integers(len(rows)))
    heading_deg = int(rng.integers(START_HEADINGS)) * 360 // START_HEADINGS
    return Pose2D(
        x_m=round(float(grid.x_m[columns[at]]), DECIMALS),
        y_m=round(float(grid.y_m[rows[at]]), DECIMALS),
        # a whole number of degrees, which a scene file can say shortly
        yaw_rad=math.radians(heading_deg if heading_deg <= 180 else heading_deg - 360),
    )
