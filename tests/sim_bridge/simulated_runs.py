"""What tests of the whole simulation share: small pictures, and runs to their end."""

from collections.abc import Callable

from robustnav_msgs_py.values import Pose2D
from sim_bridge.sensors.camera_driver import Shot, Wanted
from sim_bridge.simulation import Simulation

FreePoses = Callable[..., list[Pose2D]]

ALL = Wanted(color=True, depth=True, visible=True)
LONGEST_S = 120.0
SMALL = {"camera_width": 80, "camera_height": 60}


def shoot(simulation: Simulation, wanted: Wanted = ALL) -> Shot:
    """The picture of a camera that is neither late nor silent."""
    simulation.shoot(wanted)
    (shot,) = simulation.shots()
    return shot


def finish(simulation: Simulation) -> None:
    """Step until there is nothing more to do."""
    for _ in range(round(LONGEST_S / simulation.period_s)):
        if not (simulation.follower.busy or simulation.actions.busy) and simulation.drive.stands:
            return
        simulation.step()
    raise AssertionError("the robot never came to an end")


def told(shot: Shot) -> list[object]:
    """All bytes of a shot."""
    assert shot.color is not None
    assert shot.depth is not None
    assert shot.visible is not None
    truth = shot.visible
    arrays = (
        shot.color.pixels,
        shot.depth.depth_m,
        truth.instance,
        truth.box_px,
        truth.visible_fraction,
        truth.position_m,
    )
    return [shot.model.stamp_ns, *(array.tobytes() for array in arrays)]
