"""One ROS domain per test run, and a check that nothing is left running."""

import gc
import os
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

if TYPE_CHECKING:
    from tests.bench import Bench

# Test processes share the cores already: threads of OpenMP that wait for each other would make learning tests
# several times as slow.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# How long an example takes tells of the machine and of what else it does, not of the code.
settings.register_profile("unhurried", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("unhurried")

# Fast DDS uses UDP ports from 7400 + 250 * domain; these domains stay below Linux' ephemeral ports.
DOMAINS = range(20, 100)
MARK = "ROBUSTNAV_TEST_RUN"


def _is_free(domain: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", 7400 + 250 * domain + 10))
        except OSError:
            return False
    return True


def _free_domain() -> int:
    order = [DOMAINS[(os.getpid() + offset) % len(DOMAINS)] for offset in range(len(DOMAINS))]
    return next(domain for domain in order if _is_free(domain))


@pytest.fixture(scope="session", autouse=True)
def ros_domain(tmp_path_factory: pytest.TempPathFactory) -> int:
    """A domain of our own, on this machine only; logs go to a temporary folder."""
    domain = _free_domain()
    os.environ["ROS_DOMAIN_ID"] = str(domain)
    os.environ["ROS_LOG_DIR"] = str(tmp_path_factory.mktemp("ros_log"))
    from robustnav_nodes.graph.environment import prepare_environment

    prepare_environment(local=True)
    return domain


@pytest.fixture(scope="session", autouse=True)
def nothing_left_behind(ros_domain: int) -> Iterator[None]:
    """No process that this run started outlives it; segments of those killed on purpose are cleaned."""
    os.environ[MARK] = f"{os.getpid()} in domain {ros_domain}"  # children inherit it
    yield
    from robustnav_nodes.graph.shared_memory import clean_shared_memory

    left = [process for process in _marked_processes() if process != os.getpid()]
    clean_shared_memory()
    commands = {process: _command_line(process) for process in left}
    # Python's own helper of its shared memory; it ends with this process
    left = [process for process in left if "multiprocessing.resource_tracker" not in commands[process]]
    assert not left, f"processes {[commands[process] for process in left]} are still running"


@pytest.fixture(autouse=True)
def no_ghosts() -> Iterator[None]:
    """Nodes that a test made leave the graph with it: a context that only the garbage collector would find
    keeps its participant, which goes on to announce itself to whatever runs next."""
    before = _open_files()
    yield
    if _open_files() > before:
        gc.collect()


def _open_files() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


def _command_line(process: int) -> str:
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
    except OSError:
        return ""


def _marked_processes() -> list[int]:
    mark = f"{MARK}={os.environ[MARK]}".encode()
    found = []
    for process in Path("/proc").iterdir():
        try:
            variables = (process / "environ").read_bytes().split(b"\0") if process.name.isdigit() else []
        except OSError:  # it has just ended, or is somebody else's
            continue
        if mark in variables:
            found.append(int(process.name))
    return found


@pytest.fixture
def bench() -> Iterator["Bench"]:
    """A fresh rclpy context's worth of nodes, taken down at the end."""
    import rclpy

    from tests.bench import Bench

    rclpy.init(args=[])
    made = Bench()
    yield made
    made.spinner.close()
    for node in made.nodes:
        node.destroy_node()
    made.outside.destroy_node()
    rclpy.try_shutdown()
