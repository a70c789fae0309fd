"""What Foxglove's own JavaScript libraries read from a bag is what our reader reads, message by message."""

import dataclasses
import hashlib
import json
import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message

from bags.definitions import ament_prefixes, message_definition
from bags.offered_qos import OfferedQos
from bags.reader import RecordedMessage, open_bag
from bags.writer import BagWriter, SplitRule
from robustnav_nodes.graph.message_class import message_class
from tests.bags.conftest import CORRIDOR, MANIFEST, Talk, write_search
from tests.bags.filled_messages import TYPES, filled

DATA = Path(__file__).parents[1] / "data" / "npm"
SAMPLE = Path(__file__).parents[2] / "bags" / "samples" / "search"
OLDEST_NODE = 20
INSTALL_LIMIT_S = 15.0
READ_LIMIT_S = 30.0
LARGE = 1000  # arrays from here on are compared at once
PLACE_HOLDER = "structure_needs_at_least_one_member"  # what an empty message holds in CDR

Read = Callable[[Path], list[dict[str, Any]]]


@pytest.fixture(scope="module")
def foxglove(request: pytest.FixtureRequest) -> Read:
    """Reads a file by the libraries that the lock file names; they are installed once and kept."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        pytest.skip("node and npm are not on this machine")
    told = subprocess.run([node, "--version"], check=True, capture_output=True, text=True).stdout
    if int(told.lstrip("v").split(".")[0]) < OLDEST_NODE:
        pytest.skip(f"node {told.strip()} is older than {OLDEST_NODE}, which Foxglove's libraries need")
    version = hashlib.sha256((DATA / "package-lock.json").read_bytes()).hexdigest()[:12]
    folder = request.config.cache.mkdir(f"npm-{version}")
    for name in ("package.json", "package-lock.json", "read_bag.mjs"):
        shutil.copy(DATA / name, folder / name)
    installed = folder / "installed"
    if not installed.exists():
        command = [npm, "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--fetch-retries=0"]
        try:
            subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=INSTALL_LIMIT_S)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            pytest.skip(f"npm cannot install Foxglove's libraries here (is the registry in reach?): {error}")
        installed.touch()

    def read(path: Path) -> list[dict[str, Any]]:
        command = [node, str(folder / "read_bag.mjs"), str(path)]
        done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=READ_LIMIT_S)
        assert done.returncode == 0, done.stderr
        return [json.loads(line) for line in done.stdout.split("\n") if line]

    return read


def plain(value: Any) -> Any:
    """A decoded value as JSON has it: whole numbers stay exact, and NaN is a word."""
    if dataclasses.is_dataclass(value):
        rows = [row for row in dataclasses.fields(value) if not str(row.type).startswith("ClassVar")]
        return {row.name: plain(getattr(value, row.name)) for row in rows if row.name != PLACE_HOLDER}
    if isinstance(value, np.ndarray) and value.size >= LARGE:
        return value
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def differences(ours: Any, theirs: Any, where: str) -> list[str]:
    if isinstance(ours, np.ndarray):  # JSON's words for what is not finite are those of numpy, too
        read = np.array(theirs, dtype=ours.dtype)
        same = read.shape == ours.shape and np.array_equal(read, ours, equal_nan=ours.dtype.kind == "f")
        return [] if same else [f"{where}: other numbers"]
    if isinstance(ours, dict):
        if not isinstance(theirs, dict) or ours.keys() != theirs.keys() - {PLACE_HOLDER}:
            return [f"{where}: {theirs!r} has other fields than {ours!r}"]
        return [d for name in ours for d in differences(ours[name], theirs[name], f"{where}.{name}")]
    if isinstance(ours, list):
        if not isinstance(theirs, list) or len(theirs) != len(ours):
            return [f"{where}: {theirs!r} is not as long as {ours!r}"]
        pairs = zip(ours, theirs, strict=True)
        return [d for number, pair in enumerate(pairs) for d in differences(*pair, f"{where}[{number}]")]
    if isinstance(theirs, str) and not isinstance(ours, str):  # of 64 bits, or not finite
        words = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
        theirs = words[theirs] if theirs in words else int(theirs)
    if where.endswith(".level") and isinstance(ours, int):  # a `byte`, which rosbags reads as a signed number
        ours %= 256
    both_nan = isinstance(ours, float) and isinstance(theirs, float) and ours != ours and theirs != theirs
    return [] if both_nan or ours == theirs else [f"{where}: {theirs!r} is not {ours!r}"]


def assert_same(ours: list[RecordedMessage], theirs: list[dict[str, Any]]) -> None:
    assert len(theirs) == len(ours) > 0
    for mine, other in zip(ours, theirs, strict=True):
        assert (other["topic"], other["type"], int(other["log_time_ns"])) == (
            mine.topic,
            mine.type,
            mine.log_time_ns,
        )
        assert differences(plain(mine.message), other["message"], f"{mine.topic} at {mine.log_time_ns}") == []


def test_every_type_of_the_contract_is_read_alike(foxglove: Read, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    with BagWriter(tmp_path / "every", manifest=MANIFEST, chunk_bytes=2000) as writer:
        channels = {
            kind: writer.add_topic(f"/{kind}", message_definition(kind, ament_prefixes()), [OfferedQos()])
            for kind in TYPES
        }
        for number, kind in enumerate(TYPES * 3):
            now_ns = MANIFEST.wall_start_ns + number
            data = serialize_message(filled(message_class(kind), rng))
            writer.write(channels[kind], log_time_ns=now_ns, publish_time_ns=now_ns, data=data)
    with open_bag(tmp_path / "every") as bag:
        assert_same(list(bag.messages()), foxglove(writer.path))


def test_the_files_of_a_search_are_read_alike(foxglove: Read, tmp_path: Path) -> None:
    with BagWriter(tmp_path / "search", manifest=MANIFEST, split=SplitRule(duration_s=4.0)) as writer:
        write_search(Talk(writer), CORRIDOR.flat, CORRIDOR.told)
    files = sorted((tmp_path / "search").glob("*.mcap"))
    assert len(files) == 2
    with open_bag(tmp_path / "search") as bag:
        assert_same(list(bag.messages()), [row for file in files for row in foxglove(file)])


def test_every_message_of_a_sample_is_read_alike(foxglove: Read) -> None:
    with open_bag(SAMPLE) as bag:
        assert_same(list(bag.messages()), foxglove(SAMPLE / "search_0.mcap"))
