"""The camera as a driver gives it to a robot: pictures come when they are due, late, or not at all."""

from dataclasses import dataclass, replace

from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage, Pose2D, Velocity, VisibleObjects
from sim_bridge.sensors.degraded_camera import DegradedCamera
from sim_bridge.sensors.frame_delay import FrameDelay, FrameDropper
from sim_bridge.sensors.visibility import Observer


@dataclass(frozen=True, slots=True, kw_only=True)
class Shot:
    """What one opening of the shutter gives; what nobody asked for is None. All stamps are the same."""

    model: CameraModel
    color: ColorImage | None
    depth: DepthImage | None
    visible: VisibleObjects | None

    def without(self, *, color: bool, depth: bool) -> "Shot":
        """The shot without its picture, or without its depth."""
        return replace(self, color=None if color else self.color, depth=None if depth else self.depth)

    def holds(self, wanted: "Wanted") -> bool:
        """Whether it has all that is wanted."""
        return (
            (self.color is not None or not wanted.color)
            and (self.depth is not None or not wanted.depth)
            and (self.visible is not None or not wanted.visible)
        )

    def stamped(self, stamp_ns: int) -> "Shot":
        """The same under another stamp."""
        return Shot(
            model=replace(self.model, stamp_ns=stamp_ns),
            color=self.color and replace(self.color, stamp_ns=stamp_ns),
            depth=self.depth and replace(self.depth, stamp_ns=stamp_ns),
            visible=self.visible and replace(self.visible, stamp_ns=stamp_ns),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What somebody listens to."""

    color: bool
    depth: bool
    visible: bool


class CameraDriver:
    """Takes pictures and hands them out when they arrive. Same thread as the camera."""

    def __init__(
        self, camera: DegradedCamera, observer: Observer, dropper: FrameDropper, delay: FrameDelay[Shot]
    ) -> None:
        self._camera = camera
        self._observer = observer
        self._dropper = dropper
        self._delay = delay
        self._last: Shot | None = None

    def shoot(
        self, number: int, pose: Pose2D, velocity: Velocity, stamp_ns: int, wanted: Wanted, *, frozen: bool
    ) -> None:
        """Take picture number `number`; a frozen camera gives the last one again, under a new stamp.

        Where somebody listens to what the last one lacks, because nobody did, it takes one more.
        """
        if self._dropper.drops(number):
            return
        if not frozen or self._last is None or not self._last.holds(wanted):
            self._last = self._taken(number, pose, velocity, stamp_ns, wanted)
        self._delay.add(self._last.stamped(stamp_ns), number, stamp_ns)

    def arrived(self, now_ns: int) -> list[Shot]:
        """The pictures that have come since the last call."""
        return self._delay.due(now_ns)

    def reset(self) -> None:
        """Forget what is under way."""
        self._delay.reset()
        self._last = None

    def _taken(self, number: int, pose: Pose2D, velocity: Velocity, stamp_ns: int, wanted: Wanted) -> Shot:
        color = depth = None
        if wanted.color or wanted.depth:
            frame = self._camera.take(pose, velocity, number, stamp_ns, color=wanted.color)
            color, depth = frame.color, frame.depth
        return Shot(
            model=replace(self._camera.model, stamp_ns=stamp_ns),
            color=color,
            depth=depth,
            visible=self._observer.look(pose, stamp_ns) if wanted.visible else None,
        )
