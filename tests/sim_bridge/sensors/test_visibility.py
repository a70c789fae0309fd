"""The observer, who only sends rays, lists what the rendered picture shows."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from robustnav_msgs_py.frames import CameraMount, base_from_map, optical_from_base
from robustnav_msgs_py.values import Pose2D
from sim_bridge.sensors.camera import Camera, CameraFrame
from sim_bridge.sensors.rasterizer import NOTHING
from sim_bridge.sensors.scenery import FIRST_OTHER, scenery_of
from sim_bridge.simulation import Simulation

FreePoses = Callable[..., list[Pose2D]]


def instances(frame: CameraFrame) -> np.ndarray:
    """The object at each pixel, NOTHING where none."""
    return np.where(frame.numbers < FIRST_OTHER, frame.numbers, NOTHING)


def test_fractions_agree_with_a_picture_of_it_alone(simulation: Simulation, free_poses: FreePoses) -> None:
    home, camera = simulation.home, simulation._camera
    errors, partly = [], 0
    for thing in home.objects[::4]:
        alone = dataclasses.replace(
            home,
            rooms=(),
            walls=(),
            windows=(),
            furniture=(),
            objects=(dataclasses.replace(thing, instance=0),),
        )
        lonely = Camera(scenery_of(alone), camera.model, camera.mount, camera.range_m)
        for place in free_poses(home, 25, seed=thing.instance):
            bearing_rad = math.atan2(thing.y_m - place.y_m, thing.x_m - place.x_m)
            pose = Pose2D(x_m=place.x_m, y_m=place.y_m, yaw_rad=bearing_rad + 0.3)
            truth = simulation._observer.look(pose, 0)
            if thing.instance not in truth.instance:
                continue
            covered = (lonely.take(pose, 0, color=False).numbers != NOTHING).sum()
            if covered < 40:
                continue
            shown = instances(camera.take(pose, 0, color=False))
            fraction = float(truth.visible_fraction[truth.instance == thing.instance][0])
            errors.append(abs(fraction - (shown == thing.instance).sum() / covered))
            partly += 0.1 < fraction < 0.9
    assert len(errors) > 10
    assert partly > 0
    assert max(errors) < 0.12


def test_positions_are_centres_in_the_optical_frame(simulation: Simulation, free_poses: FreePoses) -> None:
    for pose in free_poses(simulation.home, 20, seed=3):
        truth = simulation._observer.look(pose, 42)
        assert truth.stamp_ns == 42
        assert ((truth.visible_fraction > 0.0) & (truth.visible_fraction <= 1.0)).all()
        for at, instance in enumerate(truth.instance.tolist()):
            thing = simulation.home.objects[instance]
            assert simulation.home.labels[truth.label[at]] == thing.label
            centre = optical_from_base(CameraMount(), base_from_map(pose, np.array([thing.centre_m])))[0]
            np.testing.assert_allclose(truth.position_m[at], centre, atol=1e-5)


def test_every_object_can_be_seen_from_somewhere(simulation: Simulation, free_poses: FreePoses) -> None:
    unseen = {thing.instance for thing in simulation.home.objects}
    for pose in free_poses(simulation.home, 300, seed=4):
        truth = simulation._observer.look(pose, 0)
        unseen -= set(truth.instance[truth.visible_fraction > 0.5].tolist())
        if not unseen:
            break
    assert not unseen


def test_an_empty_view_is_an_empty_list(simulation: Simulation, free_poses: FreePoses) -> None:
    views = [simulation._observer.look(pose, 0) for pose in free_poses(simulation.home, 60, seed=5)]
    empty = next(view for view in views if len(view) == 0)
    assert empty.box_px.shape == (0, 4)
    assert empty.position_m.shape == (0, 3)
