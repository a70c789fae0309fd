"""Which small objects a home holds, and where on the furniture they stand or hang."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Furniture, Surface, Wall, Window
from sim_bridge.homes.objects.catalogue import CLASSES, object_class
from sim_bridge.homes.objects.look_alikes import MIN_ALIKE, draw_count, draw_looks
from sim_bridge.homes.objects.object_class import ObjectClass
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import Look, SceneObject
from sim_bridge.homes.shapes import Vector3, extent

MIN_OBJECTS, MAX_OBJECTS = 4, 80
# Besides at least this many classes of which the home holds one object ...
UNIQUE_CLASSES = 5
# ... objects of other classes come in twos and threes; in more only where no class is left.
MAX_ALIKE, MAX_ALIKE_CROWDED = 3, 6
# Classes per object; and homes lack some classes, so that a search for what is not there can be tried.
CLASS_SHARE = (0.70, 0.95)
MAX_CLASSES = len(CLASSES) - 4
CERTAIN_LABELS = ("mug", "book")
OBJECT_GAP_M = 0.03
HEADROOM_M = 0.03
# What is lower above a surface than this stands on it as a part of the piece: nothing goes below.
LOWEST_SHELF_M = 0.10
# How far off a wall's face a picture's back may be, and what it keeps from windows.
TOUCH_M = 0.02
WINDOW_GAP_M = 0.05
YAW_SPREAD_DEG, QUARTER_TURN_DEG = 30.0, 90
TRIES = 30
# Objects stand on a grid so fine that nobody sees it, for short numbers in scene files.
PER_METRE = 1000
# What hangs touches its wall instead, as nearly as a scene file can say.
DECIMALS = 6


def arrange(
    rng: np.random.Generator,
    furniture: Sequence[Furniture],
    count: int,
    look_alikes: str = "",
    *,
    walls: Sequence[Wall] = (),
    windows: Sequence[Window] = (),
) -> tuple[SceneObject, ...]:
    """Put `count` objects (4 to 80) on furniture where they belong; no two of a class can be confused.

    Objects of one class differ in colour; where that is not enough, in something else of their look, and at
    last in the kind of furniture or the room. With `look_alikes`, a label, the home holds 3 to 9 objects of
    that class that share most of their looks. Where `walls` are given, pictures hang on them alone, beside
    doors and `windows`. Raises BadSceneError for a number out of range, an unknown label, and where the
    furniture has no room: draw again then.
    """
    if not MIN_OBJECTS <= count <= MAX_OBJECTS:
        raise BadSceneError(f"a home holds {MIN_OBJECTS} to {MAX_OBJECTS} small objects, not {count!r}")
    arrangement = _Arrangement(rng, furniture, walls, windows)
    classes = [CLASSES[int(at)] for at in rng.permutation(len(CLASSES))]
    classes.sort(key=lambda item: item.label not in CERTAIN_LABELS)
    if look_alikes:
        chosen = object_class(look_alikes)
        classes.remove(chosen)
        alike = draw_looks(rng, chosen, min(count, draw_count(rng)))
        standing = sum(arrangement.add(chosen, [look]) for look in alike)
        if standing < MIN_ALIKE:
            raise BadSceneError(
                f"the furniture has room for {standing} objects of class {look_alikes!r}, not for "
                f"{MIN_ALIKE} that look alike: choose another class or furnish the home with more"
            )
    _fill(rng, arrangement, classes, count)
    # The order says nothing: who numbers the objects by it gives away nothing.
    return tuple(arrangement.placed[int(at)].thing for at in rng.permutation(count))


def _fill(
    rng: np.random.Generator, arrangement: "_Arrangement", classes: Sequence[ObjectClass], count: int
) -> None:
    """Add objects of the classes, the first ones first, until there are `count`."""
    missing = count - len(arrangement.placed)
    needed = UNIQUE_CLASSES + math.ceil(max(0, missing - UNIQUE_CLASSES) / MAX_ALIKE)
    drawn = min(MAX_CLASSES, round(missing * rng.uniform(*CLASS_SHARE)))
    wanted = min(missing, max(needed, drawn))
    waiting = list(classes)
    alike: dict[str, int] = {}
    present: list[ObjectClass] = []
    while waiting and len(present) < wanted:
        item = waiting.pop(0)
        if arrangement.add_another(item):
            present.append(item)
            alike[item.label] = 1
    # The classes that come last in the draw stay unique.
    repeated = present[: max(0, len(present) - UNIQUE_CLASSES)]
    for most in (MAX_ALIKE, MAX_ALIKE_CROWDED):
        open_classes = [item for item in repeated if alike[item.label] < most]
        while len(arrangement.placed) < count and (open_classes or waiting):
            if not open_classes:
                arrangement.add_another(waiting.pop(0))
                continue
            item = open_classes[int(rng.integers(len(open_classes)))]
            found = arrangement.add_another(item)
            alike[item.label] += found
            if not found or alike[item.label] == most:
                open_classes.remove(item)
    if len(arrangement.placed) < count:
        raise BadSceneError(
            f"the furniture has room for {len(arrangement.placed)} objects, not for {count}: "
            f"ask for fewer or furnish the home with more"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Site:
    """A surface of a piece, and how high what stands there may be."""

    piece: Furniture
    number: int
    surface: Surface
    headroom_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Placed:
    """An object that has its place, with the box that it fills in the furniture's frame."""

    thing: SceneObject
    site: _Site
    footprint: Rect
    top_m: float

    @property
    def name(self) -> tuple[str, Look, str, str]:
        """What a person can say of it; no two objects of a home share it."""
        return self.thing.label, self.thing.look, self.site.piece.kind, self.site.piece.room

    def crowds(self, other: "_Placed") -> bool:
        """Whether the two are closer than the gap, side by side or one over the other."""
        return (
            self.thing.furniture == other.thing.furniture
            and self.site.surface.height_m < other.top_m
            and other.site.surface.height_m < self.top_m
            and self.footprint.grown(OBJECT_GAP_M).overlaps(other.footprint)
        )


class _Arrangement:
    """The objects that have found a place so far. One thread uses it while `arrange` runs."""

    def __init__(
        self,
        rng: np.random.Generator,
        furniture: Sequence[Furniture],
        walls: Sequence[Wall],
        windows: Sequence[Window],
    ) -> None:
        self.placed: list[_Placed] = []
        self._rng = rng
        self._walls = walls
        self._windows = windows
        self._sites = [
            _Site(piece=piece, number=number, surface=surface, headroom_m=headroom_m(piece, surface))
            for piece in furniture
            if piece.carries
            for number, surface in enumerate(piece.surfaces)
        ]

    def add_another(self, item: ObjectClass) -> bool:
        """Add one more object of the class, of another colour where there is one left."""
        taken = [other.thing.look for other in self.placed if other.thing.label == item.label]
        colours = {look.colour for look in taken}
        every = item.looks.all()
        fresh = [look for look in every if look.colour not in colours]
        return self.add(item, fresh or [look for look in every if look not in taken] or every)

    def add(self, item: ObjectClass, looks: Sequence[Look]) -> bool:
        """Add an object of the class with one of the looks; False where no place was found for it."""
        sites = [site for site in self._sites if site.surface.hangs == item.hangs]
        weights = np.array([item.belongs_on.get(site.piece.kind, 0.0) for site in sites])
        if not weights.any():
            return False
        shares = weights / weights.sum()
        boxes: dict[Look, tuple[Vector3, Vector3]] = {}
        for attempt in range(TRIES):
            look = looks[int(self._rng.integers(len(looks)))]
            if look not in boxes:
                boxes[look] = extent(item.parts(look))
            site = sites[int(self._rng.choice(len(sites), p=shares))]
            # Wide objects only fit when they stand straight: turn them less and less.
            spread_deg = (
                0.0 if item.hangs else YAW_SPREAD_DEG * (1.0 - attempt % (TRIES // 2) / (TRIES // 2 - 1))
            )
            turn_deg = round(self._rng.uniform(-spread_deg, spread_deg))
            # What is too deep to face the front may find room sideways.
            sideways_deg = QUARTER_TURN_DEG if attempt >= TRIES // 2 and not item.hangs else 0
            turn_rad = math.radians(turn_deg + sideways_deg)
            found = self._place(item, look, site, turn_rad, boxes[look])
            if found is not None:
                self.placed.append(found)
                return True
        return False

    def _place(
        self, item: ObjectClass, look: Look, site: _Site, turn_rad: float, box: tuple[Vector3, Vector3]
    ) -> _Placed | None:
        """The object somewhere on the surface; None where it is too large, in the way or like another."""
        low, high = box
        if high[2] > site.headroom_m:
            return None
        around = _turned(low, high, turn_rad)
        spot = self._spot(site.surface, around)
        if spot is None:
            return None
        x_m, y_m = spot
        found = _Placed(
            thing=SceneObject(
                label=item.label,
                look=look,
                furniture=site.piece.name,
                surface=site.number,
                x_m=x_m,
                y_m=y_m,
                turn_rad=turn_rad,
            ),
            site=site,
            footprint=Rect(
                x_min_m=x_m + around.x_min_m,
                y_min_m=y_m + around.y_min_m,
                x_max_m=x_m + around.x_max_m,
                y_max_m=y_m + around.y_max_m,
            ),
            top_m=site.surface.height_m + high[2],
        )
        refused = any(found.name == other.name or found.crowds(other) for other in self.placed)
        return None if refused or (item.hangs and not self._on_a_wall(found)) else found

    def _spot(self, surface: Surface, around: Rect) -> tuple[float, float] | None:
        """A point of the furniture's frame where what reaches `around` it is wholly on the surface."""
        area = surface.area
        y_m = self._between(area.y_min_m - around.y_min_m, area.y_max_m - around.y_max_m)
        if surface.hangs:
            x_m: float | None = round(area.x_min_m - around.x_min_m, DECIMALS)
            if around.width_m > area.width_m:
                return None
        else:
            x_m = self._between(area.x_min_m - around.x_min_m, area.x_max_m - around.x_max_m)
        return None if x_m is None or y_m is None else (x_m, y_m)

    def _between(self, low_m: float, high_m: float) -> float | None:
        """A point of the grid in the range; None where the range holds none."""
        low, high = math.ceil(low_m * PER_METRE), math.floor(high_m * PER_METRE)
        return int(self._rng.integers(low, high + 1)) / PER_METRE if low <= high else None

    def _on_a_wall(self, found: _Placed) -> bool:
        height_m = (found.site.surface.height_m, found.top_m)
        return is_on_a_wall(found.site.piece, found.footprint, height_m, self._walls, self._windows)


def is_on_a_wall(
    piece: Furniture,
    footprint: Rect,
    height_m: tuple[float, float],
    walls: Sequence[Wall],
    windows: Sequence[Window],
) -> bool:
    """Whether there is wall, and no window, behind what hangs above a piece, from one height to the other.

    `footprint` is in the piece's frame. Without `walls` only the windows count.
    """
    bottom_m, top_m = height_m
    back = piece.in_map(replace(footprint, x_max_m=footprint.x_min_m + TOUCH_M))
    for window in windows:
        level = bottom_m < window.z_max_m + WINDOW_GAP_M and window.z_min_m - WINDOW_GAP_M < top_m
        if level and back.grown(WINDOW_GAP_M).overlaps(window.pane):
            return False
    return not walls or any(
        wall.z_min_m <= bottom_m and top_m <= wall.z_max_m and wall.base.grown(TOUCH_M).contains(back)
        for wall in walls
    )


def headroom_m(piece: Furniture, surface: Surface) -> float:
    """How far up the next board above the surface leaves room; inf where there is none."""
    boards = [other.height_m for other in piece.surfaces if other.area.overlaps(surface.area)]
    for part in piece.parts:
        (x_m, y_m, z_m), (depth_m, width_m, thickness_m) = part.centre_m, part.size_m
        above = Rect(
            x_min_m=x_m - depth_m / 2.0,
            y_min_m=y_m - width_m / 2.0,
            x_max_m=x_m + depth_m / 2.0,
            y_max_m=y_m + width_m / 2.0,
        )
        if above.overlaps(surface.area):
            boards.append(z_m - thickness_m / 2.0)
    gaps = [board_m - surface.height_m for board_m in boards]
    return min((gap_m for gap_m in gaps if gap_m >= LOWEST_SHELF_M), default=math.inf) - HEADROOM_M


def _turned(low: Vector3, high: Vector3, turn_rad: float) -> Rect:
    """The rectangle around a box's floor once it is turned about its origin."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    corners = [(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])]
    xs = [cos * x - sin * y for x, y in corners]
    ys = [sin * x + cos * y for x, y in corners]
    return Rect(x_min_m=min(xs), y_min_m=min(ys), x_max_m=max(xs), y_max_m=max(ys))
