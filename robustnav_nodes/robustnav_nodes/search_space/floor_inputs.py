"""The map and the mask as they come in, until a search space can be built from them."""

import numpy as np

from robustnav_msgs_py.values import OccupancyMap


class FloorInputs:
    """Holds the latest map and candidate mask. Owned by a node, used in its executor thread only.

    The mask is optional: where nobody publishes one, candidates are taken from the map. Since nodes start in
    any order, a map without a mask is held back for `mask_wait_s` before it counts as "nobody".
    """

    def __init__(self, mask_wait_s: float) -> None:
        self._mask_wait_s = mask_wait_s
        self._map: OccupancyMap | None = None
        self._mask: OccupancyMap | None = None
        self._map_heard_s = 0.0
        self._is_new = False

    def heard_map(self, floor_map: OccupancyMap, now_s: float) -> None:
        """A map came; `now_s` from a monotonic clock. One that says what the last one said is no news."""
        if _same(floor_map, self._map):
            return
        self._map, self._map_heard_s, self._is_new = floor_map, now_s, True

    def heard_mask(self, mask: OccupancyMap) -> None:
        """A candidate mask came."""
        if _same(mask, self._mask):
            return
        self._mask, self._is_new = mask, True

    def take(self, now_s: float) -> tuple[OccupancyMap, OccupancyMap | None] | None:
        """Map and mask, once for each change; None while something is missing or nothing is new."""
        waited = now_s - self._map_heard_s >= self._mask_wait_s
        if not self._is_new or self._map is None or (self._mask is None and not waited):
            return None
        self._is_new = False
        return self._map, self._mask


def _same(one: OccupancyMap, other: OccupancyMap | None) -> bool:
    """Whether two maps say the same of the same floor, whenever they were stamped."""
    if other is None or (one.resolution_m, one.origin, one.frame_id) != (
        other.resolution_m,
        other.origin,
        other.frame_id,
    ):
        return False
    return np.array_equal(one.cells, other.cells)
