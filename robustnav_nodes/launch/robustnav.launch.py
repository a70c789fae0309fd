"""The nodes of a robot (or, with simulation:=true, of the simulated home), for machines that have `launch`.

ros2 launch robustnav_nodes robustnav.launch.py simulation:=true seed:=3
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

from robustnav_nodes.graph.processes import FIRST_BACK_OFF_S

ALWAYS = (
    ("robustnav_nodes", "detection"),
    ("robustnav_nodes", "belief"),
    ("robustnav_nodes", "planner"),
    ("robustnav_nodes", "dialogue"),
)


def generate_launch_description() -> LaunchDescription:
    """Arguments: simulation, record, seed, namespace, params_file."""
    simulation = LaunchConfiguration("simulation")
    namespace = LaunchConfiguration("namespace")
    shared = {
        "namespace": namespace,
        "output": "screen",
        "respawn": True,
        "respawn_delay": FIRST_BACK_OFF_S,
    }
    seed = {"seed": ParameterValue(LaunchConfiguration("seed"), value_type=int)}
    files = [LaunchConfiguration("params_file")]
    nodes = [
        Node(
            package=package,
            executable=executable,
            parameters=[*files, {"use_sim_time": ParameterValue(simulation, value_type=bool)}],
            **shared,
        )
        for package, executable in ALWAYS
    ]
    nodes.append(
        Node(
            package="sim_bridge",
            executable="sim_bridge",
            parameters=[*files, seed],
            condition=IfCondition(simulation),
            **shared,
        )
    )
    nodes.append(
        Node(
            package="bags",
            executable="recorder",
            parameters=files,
            condition=IfCondition(LaunchConfiguration("record")),
            **shared,
        )
    )
    defaults = PathJoinSubstitution([FindPackageShare("robustnav_nodes"), "config", "robustnav.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("simulation", default_value="false", description="with the simulated home"),
            DeclareLaunchArgument("record", default_value="true", description="record every topic to a bag"),
            DeclareLaunchArgument("seed", default_value="1", description="decides the simulated home"),
            DeclareLaunchArgument("namespace", default_value="", description="namespace of the robot"),
            DeclareLaunchArgument("params_file", default_value=defaults, description="ROS parameter file"),
            *nodes,
        ]
    )
