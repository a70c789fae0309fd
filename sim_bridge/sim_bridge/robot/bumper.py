"""The bumper: pressed while the robot drives against something."""

# A robot that is driven against something is let go for single steps; the bumper is not.
RELEASE_S = 0.2
ROUNDING_S = 1e-9


class Bumper:
    """Whether something touches the robot. Owned by the simulation, updated once per step."""

    def __init__(self) -> None:
        self.pressed = False
        self._free_s = 0.0

    def update(self, blocked: bool, dt_s: float) -> bool:
        """One step of `dt_s` in which the drive was `blocked` or not; True where `pressed` changed.

        The bumper is pressed at once. It is released when the robot has driven away, or has not been driven
        against the thing, for `RELEASE_S`.
        """
        self._free_s = 0.0 if blocked else self._free_s + dt_s
        before = self.pressed
        self.pressed = blocked or (before and self._free_s < RELEASE_S - ROUNDING_S)
        return self.pressed != before
