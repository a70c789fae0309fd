"""From the name of a message or service type to its class."""

from importlib import import_module
from typing import Any


def message_class(name: str) -> Any:
    """The class of a type as ROS writes it: "std_msgs/msg/String", "std_srvs/srv/Trigger"."""
    package, kind, type_name = name.split("/")
    return getattr(import_module(f"{package}.{kind}"), type_name)
