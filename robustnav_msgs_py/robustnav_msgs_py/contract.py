"""The one table of topics and services: name, type, quality of service, who speaks, who listens.

Nodes take names, types and QoS from here (`robustnav_nodes.graph.node`), the README's tables are
generated from here, and a test holds the running graph against it. Names are relative, so that namespaces
and remappings work, but for those that ROS fixes (`/clock`, `/diagnostics`, `/tf`).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from importlib.util import find_spec

from robustnav_msgs_py.errors import ContractError

EVERY_NODE = "every node"


@dataclass(frozen=True, slots=True, kw_only=True)
class Qos:
    """Quality of service of a topic, as its publisher offers it and as its listeners ask for it.

    Listeners that ask for less than is offered always match; `hear_best_effort` and `hear_depth` are
    what our own listeners ask for.
    """

    name: str
    depth: int
    latched: bool = False
    hear_best_effort: bool = False
    hear_depth: int | None = None


SENSOR = Qos(name="sensor", depth=5, hear_best_effort=True, hear_depth=5)
IMAGE = Qos(name="image", depth=2, hear_best_effort=True, hear_depth=1)
LATCHED = Qos(name="latched", depth=1, latched=True)
COMMAND = Qos(name="command", depth=1)
RECORD = Qos(name="record", depth=100)
CHAT_IN = Qos(name="chat", depth=50)
CHAT_OUT = Qos(name="chat, latched", depth=50, latched=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """One topic: `speakers` and `listeners` are executables' names (several may share a topic).

    `optional`: its message is in no wheel; the topic is there where the message's package is installed.
    """

    name: str
    type: str
    qos: Qos
    speakers: tuple[str, ...]
    listeners: tuple[str, ...]
    meaning: str
    optional: bool = False

    @property
    def is_available(self) -> bool:
        """Whether this machine knows the message."""
        return not self.optional or find_spec(self.type.partition("/")[0]) is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """One service; a name that starts with `~/` is private to the node that serves it."""

    name: str
    type: str
    server: str
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeRow:
    """One executable and what it is for; one that is not `in_graph` is started by hand, beside the graph."""

    package: str
    executable: str
    purpose: str
    in_graph: bool = True


NODES = (
    NodeRow(
        package="sim_bridge",
        executable="sim_bridge",
        purpose="a simulated home and robot, where a robot stands",
    ),
    NodeRow(
        package="robustnav_nodes", executable="detection", purpose="objects in the camera image, with places"
    ),
    NodeRow(
        package="robustnav_nodes", executable="belief", purpose="where the target may be, by Bayes' rule"
    ),
    NodeRow(
        package="robustnav_nodes", executable="planner", purpose="where to look next, by POMCP, and docking"
    ),
    NodeRow(
        package="robustnav_nodes", executable="dialogue", purpose="the front door: talks with the person"
    ),
    NodeRow(
        package="robustnav_nodes", executable="simulated_user", purpose="a person who asks for an object"
    ),
    NodeRow(package="bags", executable="recorder", purpose="every topic into an MCAP bag with a manifest"),
    NodeRow(package="robustnav_nodes", executable="manager", purpose="brings the nodes up and keeps them up"),
    NodeRow(package="bags", executable="player", purpose="every topic of a bag, as recorded", in_graph=False),
)

TOPICS = (
    Topic(
        name="/clock",
        type="rosgraph_msgs/msg/Clock",
        qos=COMMAND,
        speakers=("sim_bridge", "player"),
        listeners=(),
        meaning="simulated time, or that of a bag that is played",
    ),
    Topic(
        name="camera/image_raw",
        type="sensor_msgs/msg/Image",
        qos=IMAGE,
        speakers=("sim_bridge",),
        listeners=("detection",),
        meaning="colour image, rgb8",
    ),
    Topic(
        name="camera/depth/image_raw",
        type="sensor_msgs/msg/Image",
        qos=IMAGE,
        speakers=("sim_bridge",),
        listeners=("detection",),
        meaning="depth along the optical axis, 32FC1, m",
    ),
    Topic(
        name="camera/camera_info",
        type="sensor_msgs/msg/CameraInfo",
        qos=IMAGE,
        speakers=("sim_bridge",),
        listeners=("detection",),
        meaning="pinhole model of the camera",
    ),
    Topic(
        name="scan",
        type="sensor_msgs/msg/LaserScan",
        qos=SENSOR,
        speakers=("sim_bridge",),
        listeners=(),
        meaning="laser scan around the robot",
    ),
    Topic(
        name="odom",
        type="nav_msgs/msg/Odometry",
        qos=SENSOR,
        speakers=("sim_bridge",),
        listeners=("detection", "belief", "planner", "dialogue"),
        meaning="where the robot is in the map, and how it moves",
    ),
    Topic(
        name="/tf",
        type="tf2_msgs/msg/TFMessage",
        qos=RECORD,
        speakers=("sim_bridge",),
        listeners=(),
        meaning="map -> odom -> base_link, where tf2_msgs is installed",
        optional=True,
    ),
    Topic(
        name="/tf_static",
        type="tf2_msgs/msg/TFMessage",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=(),
        meaning="base_link -> camera and laser, where tf2_msgs is installed",
        optional=True,
    ),
    Topic(
        name="bumper",
        type="std_msgs/msg/Bool",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=(),
        meaning="whether the robot pushes against something; said when it changes",
    ),
    Topic(
        name="map",
        type="nav_msgs/msg/OccupancyGrid",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=("belief", "planner"),
        meaning="floor plan: free, occupied, unknown",
    ),
    Topic(
        name="search/candidates",
        type="nav_msgs/msg/OccupancyGrid",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=("belief", "planner"),
        meaning="mask of the cells that can hold an object",
    ),
    Topic(
        name="truth/objects",
        type="visualization_msgs/msg/MarkerArray",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=("simulated_user",),
        meaning="ground truth: every object of the home",
    ),
    Topic(
        name="truth/labels",
        type="std_msgs/msg/String",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=("detection",),
        meaning="class names that truth/visible's label numbers stand for, comma-separated",
    ),
    Topic(
        name="truth/visible",
        type="sensor_msgs/msg/PointCloud2",
        qos=SENSOR,
        speakers=("sim_bridge",),
        listeners=("detection",),
        meaning="ground truth: the objects in the latest image",
    ),
    Topic(
        name="truth/episode",
        type="diagnostic_msgs/msg/DiagnosticStatus",
        qos=LATCHED,
        speakers=("sim_bridge",),
        listeners=(),
        meaning="ground truth: seed, rooms, start pose",
    ),
    Topic(
        name="cmd_vel",
        type="geometry_msgs/msg/Twist",
        qos=COMMAND,
        speakers=(),
        listeners=("sim_bridge",),
        meaning="velocity command; the robot stops when it stops coming",
    ),
    Topic(
        name="goal_pose",
        type="geometry_msgs/msg/PoseStamped",
        qos=COMMAND,
        speakers=("planner",),
        listeners=("sim_bridge",),
        meaning="next place to drive to, as RViz and Nav2 speak it",
    ),
    Topic(
        name="action",
        type="std_msgs/msg/String",
        qos=RECORD,
        speakers=(),
        listeners=("sim_bridge",),
        meaning="one discrete action, as `forward`, `left 30`; the robot ends exactly there",
    ),
    Topic(
        name="sim/fault",
        type="std_msgs/msg/String",
        qos=RECORD,
        speakers=(),
        listeners=("sim_bridge",),
        meaning="what goes wrong in the simulation, as `silent camera 5`, `clear`",
    ),
    Topic(
        name="initialpose",
        type="geometry_msgs/msg/PoseWithCovarianceStamped",
        qos=COMMAND,
        speakers=(),
        listeners=("sim_bridge",),
        meaning="puts the simulated robot somewhere else",
    ),
    Topic(
        name="detections",
        type="sensor_msgs/msg/PointCloud2",
        qos=SENSOR,
        speakers=("detection",),
        listeners=("belief",),
        meaning="one point per detection: place, score, label, box",
    ),
    Topic(
        name="detections/labels",
        type="std_msgs/msg/String",
        qos=LATCHED,
        speakers=("detection",),
        listeners=("belief", "dialogue"),
        meaning="class names that the label numbers stand for, comma-separated",
    ),
    Topic(
        name="detections/boxes",
        type="sensor_msgs/msg/Image",
        qos=IMAGE,
        speakers=("detection",),
        listeners=(),
        meaning="the image with the boxes drawn in, while somebody listens",
    ),
    Topic(
        name="detections/markers",
        type="visualization_msgs/msg/MarkerArray",
        qos=SENSOR,
        speakers=("detection",),
        listeners=(),
        meaning="the detections to look at in RViz or Foxglove",
    ),
    Topic(
        name="detections/vision",
        type="vision_msgs/msg/Detection3DArray",
        qos=SENSOR,
        speakers=("detection",),
        listeners=(),
        meaning="the detections once more, where vision_msgs is installed",
        optional=True,
    ),
    Topic(
        name="belief/cloud",
        type="sensor_msgs/msg/PointCloud2",
        qos=LATCHED,
        speakers=("belief",),
        listeners=("planner",),
        meaning="candidate locations and their probabilities, exact",
    ),
    Topic(
        name="belief/map",
        type="nav_msgs/msg/OccupancyGrid",
        qos=LATCHED,
        speakers=("belief",),
        listeners=(),
        meaning="the belief as a picture, 0..98",
    ),
    Topic(
        name="belief/entropy",
        type="std_msgs/msg/Float64",
        qos=RECORD,
        speakers=("belief",),
        listeners=(),
        meaning="entropy of the belief over its maximum, 0..1",
    ),
    Topic(
        name="belief/detector",
        type="diagnostic_msgs/msg/DiagnosticStatus",
        qos=LATCHED,
        speakers=("belief",),
        listeners=(),
        meaning="how good the detector is believed to be on the target's class",
    ),
    Topic(
        name="search/facts",
        type="std_msgs/msg/String",
        qos=RECORD,
        speakers=("dialogue",),
        listeners=("belief",),
        meaning="what the person says about a find: `confirmed mug`, `refuted mug`",
    ),
    Topic(
        name="search/target",
        type="std_msgs/msg/String",
        qos=LATCHED,
        speakers=("dialogue",),
        listeners=("belief", "planner"),
        meaning="class of the object to find; empty: none",
    ),
    Topic(
        name="search/state",
        type="diagnostic_msgs/msg/DiagnosticStatus",
        qos=LATCHED,
        speakers=("planner",),
        listeners=("belief", "dialogue"),
        meaning="how the search stands",
    ),
    Topic(
        name="planner/decision",
        type="diagnostic_msgs/msg/DiagnosticStatus",
        qos=RECORD,
        speakers=("planner",),
        listeners=("dialogue",),
        meaning="each decision with every action's value and visits",
    ),
    Topic(
        name="plan",
        type="nav_msgs/msg/Path",
        qos=LATCHED,
        speakers=("planner",),
        listeners=(),
        meaning="way to the next place",
    ),
    Topic(
        name="chat/from_user",
        type="std_msgs/msg/String",
        qos=CHAT_IN,
        speakers=("simulated_user",),
        listeners=("dialogue",),
        meaning="what the person says, one line",
    ),
    Topic(
        name="chat/to_user",
        type="std_msgs/msg/String",
        qos=CHAT_OUT,
        speakers=("dialogue",),
        listeners=("simulated_user",),
        meaning="what the robot says, one line",
    ),
    Topic(
        name="dialogue/state",
        type="diagnostic_msgs/msg/DiagnosticStatus",
        qos=LATCHED,
        speakers=("dialogue",),
        listeners=(),
        meaning="what the dialogue is about",
    ),
    Topic(
        name="/diagnostics",
        type="diagnostic_msgs/msg/DiagnosticArray",
        qos=RECORD,
        speakers=(EVERY_NODE,),
        listeners=(),
        meaning="health of every node, once a second",
    ),
)

SERVICES = (
    Service(name="~/reset", type="std_srvs/srv/Trigger", server="sim_bridge", meaning="back to the start"),
    Service(name="~/pause", type="std_srvs/srv/SetBool", server="sim_bridge", meaning="hold simulated time"),
    Service(
        name="~/step",
        type="std_srvs/srv/Trigger",
        server="sim_bridge",
        meaning="advance one period while paused",
    ),
    Service(
        name="belief/get_map",
        type="nav_msgs/srv/GetMap",
        server="belief",
        meaning="the belief as a grid, now",
    ),
    Service(name="~/reset", type="std_srvs/srv/Trigger", server="belief", meaning="forget every observation"),
    Service(
        name="~/start", type="std_srvs/srv/Trigger", server="planner", meaning="search for the target again"
    ),
    Service(
        name="~/stop", type="std_srvs/srv/Trigger", server="planner", meaning="stop the search and the robot"
    ),
    Service(name="~/pause", type="std_srvs/srv/SetBool", server="player", meaning="hold the time of the bag"),
    Service(
        name="~/step",
        type="std_srvs/srv/Trigger",
        server="player",
        meaning="say the next message while paused",
    ),
    Service(name="~/reset", type="std_srvs/srv/Trigger", server="player", meaning="play from the start"),
    Service(name="~/startup", type="std_srvs/srv/Trigger", server="manager", meaning="bring every node up"),
    Service(
        name="~/shutdown",
        type="std_srvs/srv/Trigger",
        server="manager",
        meaning="take every node down, last one first",
    ),
    Service(
        name="~/split",
        type="std_srvs/srv/Trigger",
        server="recorder",
        meaning="go on in the bag's next file",
    ),
    Service(
        name="plan/get_plan",
        type="nav_msgs/srv/GetPlan",
        server="planner",
        meaning="shortest way on the pose graph",
    ),
)


def topic(name: str) -> Topic:
    """The topic called `name`; raises ContractError where there is none."""
    for row in TOPICS:
        if row.name == name:
            return row
    raise ContractError(f"no topic {name!r} in the contract; add it to contract.TOPICS")


def service(name: str, server: str) -> Service:
    """The service `name` of `server`; raises ContractError where there is none."""
    for row in SERVICES:
        if row.name == name and row.server == server:
            return row
    raise ContractError(f"no service {name!r} of {server!r} in the contract; add it to contract.SERVICES")


def spoken_by(executable: str) -> tuple[Topic, ...]:
    """Topics that `executable` publishes; of the optional ones those that are available here."""
    said = (row for row in TOPICS if executable in row.speakers or EVERY_NODE in row.speakers)
    return _of(executable, (row for row in said if row.is_available))


def heard_by(executable: str) -> tuple[Topic, ...]:
    """Topics that `executable` subscribes to."""
    return _of(executable, (row for row in TOPICS if executable in row.listeners))


def served_by(executable: str) -> tuple[Service, ...]:
    """Services of `executable`."""
    return tuple(row for row in SERVICES if row.server == executable)


def _of(executable: str, rows: Iterable[Topic]) -> tuple[Topic, ...]:
    if executable not in {node.executable for node in NODES}:
        raise ContractError(f"no executable {executable!r} in the contract; add it to contract.NODES")
    return tuple(rows)
