"""The robot's camera with everything that is wrong with it."""

import dataclasses

from robustnav_msgs_py.values import CameraModel, Pose2D, Velocity
from sim_bridge.sensors.camera import Camera, CameraFrame
from sim_bridge.sensors.degradations import ImageDegradation
from sim_bridge.sensors.depth_noise import DepthSensor
from sim_bridge.sensors.image_noise import ImageSensor
from sim_bridge.sensors.motion_blur import blur_poses, mean_image


class DegradedCamera:
    """Takes a perfect camera's pictures and makes them worse. Same thread as the camera."""

    def __init__(self, camera: Camera, degradation: ImageDegradation, seed: int) -> None:
        """`seed` decides the noise, together with each frame's number."""
        self._camera = camera
        self._degradation = degradation
        self._image_sensor = ImageSensor(degradation, camera.model, seed)
        self._depth_sensor = DepthSensor(degradation, camera.model, seed)

    @property
    def model(self) -> CameraModel:
        """The camera's pinhole model."""
        return self._camera.model

    def take(
        self, pose: Pose2D, velocity: Velocity, frame: int, stamp_ns: int, *, color: bool = True
    ) -> CameraFrame:
        """Frame number `frame`: what the robot sees that is at `pose` half-way through the exposure.

        A robot that turns costs up to five renderings. Depth and numbers are of the middle one.
        """
        if not color:
            sharp = self._camera.take(pose, stamp_ns, color=False)
            return dataclasses.replace(sharp, depth=self._depth_sensor.sensed(sharp.depth, frame))
        poses = blur_poses(pose, velocity, self._degradation.exposure_s, self._camera.model)
        pictures = [self._camera.take(at, stamp_ns) for at in poses]
        middle = pictures[len(pictures) // 2]
        image = mean_image([picture.color for picture in pictures if picture.color is not None])
        return dataclasses.replace(
            middle,
            color=self._image_sensor.sensed(image, frame),
            depth=self._depth_sensor.sensed(middle.depth, frame),
        )
