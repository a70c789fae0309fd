"""The robot's camera with everything that is wrong with it."""

import dataclasses

from robustnav_msgs_py.values import Pose2D, Velocity
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

    def take(self, pose: Pose2D, velocity: Velocity, frame: int, stamp_ns: int) -> CameraFrame:
        """Frame number `frame`: what the robot sees that is at `pose` half-way through the exposure.

        A robot that turns costs up to five renderings. Depth and bodies are of the middle one.
        """
        poses = blur_poses(pose, velocity, self._degradation.exposure_s, self._camera.model)
        pictures = [self._camera.take(at, stamp_ns) for at in poses]
        middle = pictures[len(pictures) // 2]
        color = mean_image([picture.color for picture in pictures])
        return dataclasses.replace(
            middle,
            color=self._image_sensor.sensed(color, frame),
            depth=self._depth_sensor.sensed(middle.depth, frame),
        )
