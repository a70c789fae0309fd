"""Puts together the parts of one image that come on several topics with the same stamp."""

from dataclasses import dataclass

from robustnav_msgs_py.values import ColorImage, DepthImage, VisibleObjects


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImageParts:
    """What belongs to one stamp; None has not come, and may never where it is not needed."""

    stamp_ns: int
    color: ColorImage | None = None
    depth: DepthImage | None = None
    seen: VisibleObjects | None = None


class LatestImages:
    """Keeps the parts of the latest few images until one is complete; older ones are then forgotten.

    An image is complete when its depth and, for a back end that looks at the pixels (`by_color`), its colour
    have come, for another what is seen in it. Never a queue: a complete image drops every older one. A stamp
    far behind the newest means that time began anew (the simulation was reset): everything kept is forgotten.
    """

    def __init__(self, keep: int, *, by_color: bool = False, restart_ns: int = 1_000_000_000) -> None:
        self._keep = keep
        self._by_color = by_color
        self._restart_ns = restart_ns
        self._parts: dict[int, ImageParts] = {}
        self._done_ns: int | None = None

    def add(
        self,
        stamp_ns: int,
        *,
        color: ColorImage | None = None,
        depth: DepthImage | None = None,
        seen: VisibleObjects | None = None,
    ) -> ImageParts | None:
        """Add one part; returns the image when this part completes it."""
        if self._done_ns is not None and stamp_ns < self._done_ns - self._restart_ns:
            self._parts, self._done_ns = {}, None
        if self._done_ns is not None and stamp_ns <= self._done_ns:
            return None
        parts = self._parts.get(stamp_ns, ImageParts(stamp_ns=stamp_ns))
        parts = ImageParts(
            stamp_ns=stamp_ns,
            color=parts.color if color is None else color,
            depth=parts.depth if depth is None else depth,
            seen=parts.seen if seen is None else seen,  # not `or`: seeing nothing is false, and tells much
        )
        self._parts[stamp_ns] = parts
        while len(self._parts) > self._keep:
            del self._parts[min(self._parts)]
        looked_at = parts.color if self._by_color else parts.seen
        if parts.depth is None or looked_at is None:
            return None
        self._parts = {stamp: kept for stamp, kept in self._parts.items() if stamp > stamp_ns}
        self._done_ns = stamp_ns
        return parts
