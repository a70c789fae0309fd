"""The classes of the standard messages that values are converted to.

They are ROS's own where it is installed. Where it is not, as on a desk at which bags are looked into, those
of rosbags stand in for them: the same fields and constants, but no defaults and no way onto the wire. To read
messages that rosbags decoded, no more is needed.
"""

try:
    from builtin_interfaces.msg import Duration, Time
    from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
    from geometry_msgs.msg import (
        Point,
        Pose,
        PoseStamped,
        Quaternion,
        Transform,
        TransformStamped,
        Twist,
        Vector3,
    )
    from nav_msgs.msg import MapMetaData, OccupancyGrid, Odometry, Path
    from rosgraph_msgs.msg import Clock
    from sensor_msgs.msg import CameraInfo, Image, LaserScan, PointCloud2, PointField
    from std_msgs.msg import Bool, ColorRGBA, Header, String
    from visualization_msgs.msg import Marker, MarkerArray
except ModuleNotFoundError:
    from rosbags.typesys.stores.ros2_jazzy import builtin_interfaces__msg__Duration as Duration
    from rosbags.typesys.stores.ros2_jazzy import builtin_interfaces__msg__Time as Time
    from rosbags.typesys.stores.ros2_jazzy import diagnostic_msgs__msg__DiagnosticStatus as DiagnosticStatus
    from rosbags.typesys.stores.ros2_jazzy import diagnostic_msgs__msg__KeyValue as KeyValue
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__Point as Point
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__Pose as Pose
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__PoseStamped as PoseStamped
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__Quaternion as Quaternion
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__Transform as Transform
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__TransformStamped as TransformStamped
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__Twist as Twist
    from rosbags.typesys.stores.ros2_jazzy import geometry_msgs__msg__Vector3 as Vector3
    from rosbags.typesys.stores.ros2_jazzy import nav_msgs__msg__MapMetaData as MapMetaData
    from rosbags.typesys.stores.ros2_jazzy import nav_msgs__msg__OccupancyGrid as OccupancyGrid
    from rosbags.typesys.stores.ros2_jazzy import nav_msgs__msg__Odometry as Odometry
    from rosbags.typesys.stores.ros2_jazzy import nav_msgs__msg__Path as Path
    from rosbags.typesys.stores.ros2_jazzy import rosgraph_msgs__msg__Clock as Clock
    from rosbags.typesys.stores.ros2_jazzy import sensor_msgs__msg__CameraInfo as CameraInfo
    from rosbags.typesys.stores.ros2_jazzy import sensor_msgs__msg__Image as Image
    from rosbags.typesys.stores.ros2_jazzy import sensor_msgs__msg__LaserScan as LaserScan
    from rosbags.typesys.stores.ros2_jazzy import sensor_msgs__msg__PointCloud2 as PointCloud2
    from rosbags.typesys.stores.ros2_jazzy import sensor_msgs__msg__PointField as PointField
    from rosbags.typesys.stores.ros2_jazzy import std_msgs__msg__Bool as Bool
    from rosbags.typesys.stores.ros2_jazzy import std_msgs__msg__ColorRGBA as ColorRGBA
    from rosbags.typesys.stores.ros2_jazzy import std_msgs__msg__Header as Header
    from rosbags.typesys.stores.ros2_jazzy import std_msgs__msg__String as String
    from rosbags.typesys.stores.ros2_jazzy import visualization_msgs__msg__Marker as Marker
    from rosbags.typesys.stores.ros2_jazzy import visualization_msgs__msg__MarkerArray as MarkerArray

__all__ = [
    "Bool",
    "CameraInfo",
    "Clock",
    "ColorRGBA",
    "DiagnosticStatus",
    "Duration",
    "Header",
    "Image",
    "KeyValue",
    "LaserScan",
    "MapMetaData",
    "Marker",
    "MarkerArray",
    "OccupancyGrid",
    "Odometry",
    "Path",
    "Point",
    "PointCloud2",
    "PointField",
    "Pose",
    "PoseStamped",
    "Quaternion",
    "String",
    "Time",
    "Transform",
    "TransformStamped",
    "Twist",
    "Vector3",
]
