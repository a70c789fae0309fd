"""Who may import whom (the layers of the design), and where an algorithm's constants may stand."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {
    name: ROOT / name / name for name in ("robustnav_msgs_py", "robustnav_nodes", "sim_bridge", "bags")
}
SOURCES = sorted(path for folder in PACKAGES.values() for path in folder.rglob("*.py"))
NODES = sorted(path for path in SOURCES if path.name == "node.py" and path.parent.name != "graph")

# The wiring: a node.py, what all nodes share, the people's side, the bags (the recorder), the command line.
MAY_KNOW_ROS = ("robustnav_nodes/graph/", "robustnav_nodes/chat/", "bags/bags/")
SHARED = {"search_space", "worker_pool"}
HARMLESS = {-1, 0, 1, 2, 1e3, 1e-3, 1e6, 1e-6, 1e9, 1e-9}


def imports(path: Path) -> Iterator[str]:
    """Every module that a file imports, also inside functions."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield node.module


def knows_ros(path: Path) -> bool:
    return any(module == "rclpy" or module.startswith("rclpy.") for module in imports(path))


def constants(path: Path) -> list[tuple[int, object]]:
    """Numbers written into a file, but for those that count (-1 to 2) and unit prefixes."""
    return [
        (node.lineno, node.value)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value not in HARMLESS
    ]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_capabilities_do_not_know_ros(path: Path) -> None:
    relative = path.relative_to(ROOT).as_posix()
    allowed = path.name == "node.py" or any(part in relative for part in MAY_KNOW_ROS)
    assert allowed or not knows_ros(path), f"{relative} imports rclpy; the wiring belongs into node.py"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_capabilities_do_not_know_each_other(path: Path) -> None:
    parts = path.relative_to(ROOT).parts
    if parts[0] != "robustnav_nodes" or len(parts) < 4 or parts[2] in ("graph", "benchmarks"):
        return
    own = parts[2]
    for module in imports(path):
        names = module.split(".")
        if names[0] == "robustnav_nodes" and len(names) > 1:
            shared = (
                names[1] in SHARED | {own}
                or (names[1] == "graph" and path.name == "node.py")
                or own == "chat"
            )
            assert shared, f"{'/'.join(parts)} imports {module}, another capability"


@pytest.mark.parametrize("path", NODES, ids=lambda path: path.parent.name)
def test_nodes_hold_no_constants_of_an_algorithm(path: Path) -> None:
    assert not constants(path), f"{path.parent.name}/node.py: numbers belong into parameters.py"


def test_values_and_wire_stand_on_nothing_of_ours() -> None:
    for path in PACKAGES["robustnav_msgs_py"].rglob("*.py"):
        ours = {module.split(".")[0] for module in imports(path)} & set(PACKAGES)
        assert ours <= {"robustnav_msgs_py"}, path


def test_these_tests_can_fail(tmp_path: Path) -> None:
    bad = tmp_path / "node.py"
    bad.write_text("def f():\n    import rclpy.node\n    return 0.97\n", encoding="utf-8")
    assert knows_ros(bad)
    assert constants(bad) == [(3, 0.97)]
