"""The home as it stands now: what is moved, what is blocked, and what the robot can touch and see."""

from collections.abc import Sequence
from dataclasses import replace
from types import TracebackType

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.home import DOOR_HEIGHT_M, Door, Furniture, Home, SmallObject
from sim_bridge.homes.materials import material
from sim_bridge.homes.objects.moving import moved
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.shapes import box
from sim_bridge.sensors.scenery import Item, Scenery, scenery_of
from sim_bridge.sensors.world import World

DOOR_LEAF = material("cream wood")


class Stage:
    """One home with what was moved into it. Owned by the simulation; same thread. Close it when done.

    `home` is the home as the map knows it, its objects where they are now. `obstacles` and `grid` hold all
    that the robot must not touch, `world` all that rays meet, `scenery` all that is to be seen.
    """

    def __init__(self, home: Home, moved_in: Sequence[Furniture] = ()) -> None:
        """Build it (some 100 ms). Raises BadSceneError where PyBullet has no world left."""
        self.home = home
        self._at_first = home.objects
        whole = replace(home, furniture=(*home.furniture, *moved_in))
        self._rects = whole.obstacles()
        self._free_grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(self._rects)
        self._whole_scenery = scenery_of(whole)
        self._closed: tuple[Door, ...] = ()
        self._leaves: list[int] = []
        self.grid = self._free_grid
        self.obstacles = Obstacles(self._rects, home.bounds)
        self.scenery = self._whole_scenery
        self.world = World(whole)

    def close(self) -> None:
        """Give PyBullet's world back; a second call does nothing."""
        self.world.close()

    def __enter__(self) -> "Stage":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def closed(self) -> tuple[Door, ...]:
        """The doors that nobody passes."""
        return self._closed

    def close_doors(self, doors: Sequence[Door]) -> None:
        """Shut these doors, and open all others."""
        openings = tuple(door.opening for door in doors)
        self.obstacles = Obstacles((*self._rects, *openings), self.home.bounds)
        self.grid = self._free_grid.with_rects(openings)
        for body in self._leaves:
            self.world.remove(body)
        size = [(rect.width_m, rect.depth_m, DOOR_HEIGHT_M) for rect in openings]
        places = [(*rect.centre_m, DOOR_HEIGHT_M / 2.0) for rect in openings]
        self._leaves = [self.world.add_box(*leaf) for leaf in zip(places, size, strict=True)]
        first = max(self._whole_scenery.items) + 1
        leaves = [
            Item(
                number=first + at,
                name=f"door between {' and '.join(door.rooms)}",
                parts=(box(places[at], size[at], DOOR_LEAF),),
                light_m=self._lamp_of(door),
            )
            for at, door in enumerate(doors)
        ]
        self.scenery = (
            Scenery([*self._whole_scenery.items.values(), *leaves]) if leaves else self._whole_scenery
        )
        for thing in self.home.objects:
            self._show(thing)
        self._closed = tuple(doors)

    def move(self, rng: np.random.Generator, instance: int, furniture: str) -> SmallObject:
        """Put an object somewhere on another piece. Raises BadMessageError where it has no room there."""
        pieces = {piece.name: piece for piece in self.home.furniture}
        if not 0 <= instance < len(self.home.objects) or furniture not in pieces:
            raise BadMessageError(
                f"there is no object {instance!r} or no furniture {furniture!r} in this home"
            )
        thing = self.home.objects[instance]
        others = [other for other in self.home.objects if other.instance != instance]
        put = moved(rng, thing, pieces[furniture], others, walls=self.home.walls, windows=self.home.windows)
        self.home = replace(
            self.home, objects=tuple(put if other is thing else other for other in self.home.objects)
        )
        self._put(put)
        return put

    def put_back(self) -> bool:
        """Put every object back that was moved; whether there was one."""
        moved_away = [
            thing for thing, now in zip(self._at_first, self.home.objects, strict=True) if now is not thing
        ]
        self.home = replace(self.home, objects=self._at_first)
        for thing in moved_away:
            self._put(thing)
        return bool(moved_away)

    def _put(self, thing: SmallObject) -> None:
        self.world.move(thing.instance, thing.x_m, thing.y_m, thing.z_m, thing.yaw_rad)
        self._show(thing)

    def _show(self, thing: SmallObject) -> None:
        self.scenery.move(thing.instance, thing.x_m, thing.y_m, thing.z_m, thing.yaw_rad)

    def _lamp_of(self, door: Door) -> tuple[float, float, float]:
        """The lamp of the first of the door's rooms."""
        room = next(room for room in self.home.rooms if room.name == door.rooms[0])
        return next(
            item.light_m
            for item in self._whole_scenery.items.values()
            if item.name == f"floor of {room.name}"
        )
