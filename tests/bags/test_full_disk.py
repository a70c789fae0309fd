"""A recorder whose disk is full says so and keeps what was flushed, and the graph lives on."""

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.experimental import EventsExecutor
from std_msgs.msg import String

from bags.manifest import Manifest
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError

LIMIT_S = 30.0
ROOM_BYTES = 2_000_000
UNSHARE = ["unshare", "--map-root-user", "--mount"]
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def mounts_are_permitted() -> bool:
    if shutil.which("unshare") is None:
        return False
    command = [*UNSHARE, "mount", "-t", "tmpfs", "none", "/mnt"]
    return subprocess.run(command, check=False, capture_output=True).returncode == 0


def word(number: int) -> str:
    """Some 20 kB that begin with a number and cannot be compressed much."""
    return f"{number} " + random.Random(number).randbytes(10_000).hex()


class Room:
    """A recorder in a process of its own, a node that speaks to it, and what /diagnostics say of it."""

    def __init__(self, folder: Path, log: IO[str]) -> None:
        self.folder, self.log = folder, log
        self.process: subprocess.Popen[str] | None = None
        self.told: list[DiagnosticStatus] = []
        self.said = 0
        self.node = rclpy.create_node("talker")
        self.executor = EventsExecutor()
        self.executor.add_node(self.node)
        self.publisher = self.node.create_publisher(String, "words", 100)
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self._hear, 10)

    def start(self, *before: str) -> None:
        """Start the recorder; `before` is a command that runs it."""
        recorder = [sys.executable, "-m", "bags.recorder", "--ros-args", "-p", f"folder:={self.folder}"]
        options = ["-p", "name:=run", "-p", "flush_period_s:=0.1", "-p", "discovery_period_s:=0.05"]
        self.process = subprocess.Popen([*before, *recorder, *options], stderr=self.log, text=True)
        self.until(lambda: self.publisher.get_subscription_count() == 1)

    @property
    def bag(self) -> Path:
        """The bag as the recorder sees it, whose mounts may be its own."""
        assert self.process is not None
        return Path(f"/proc/{self.process.pid}/root{self.folder}/run")

    @property
    def cpu_s(self) -> float:
        assert self.process is not None
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS_PER_S

    def speak(self) -> None:
        self.publisher.publish(String(data=word(self.said)))
        self.said += 1

    def until(self, holds: Callable[[], bool]) -> None:
        deadline = time.monotonic() + LIMIT_S
        while not holds():
            assert time.monotonic() < deadline, "what the test waits for did not come"
            self.executor.spin_once(timeout_sec=0.02)

    def close(self) -> None:
        if self.process is not None and self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.executor.shutdown()  # it holds the nodes, which would stay in the graph
        self.node.destroy_node()

    def _hear(self, message: DiagnosticArray) -> None:
        self.told += [status for status in message.status if status.name.endswith("/recorder")]


@pytest.fixture
def room(tmp_path: Path) -> Iterator[Room]:
    rclpy.init()
    (tmp_path / "bags").mkdir()
    with (tmp_path / "log").open("w") as log:
        made = Room(tmp_path / "bags", log)
        try:
            yield made
        finally:
            made.close()
            rclpy.try_shutdown()


def words(path: Path) -> list[int]:
    with open_bag(path) as bag:
        return [int(recorded.message.data.split()[0]) for recorded in bag.messages(["/words"])]


def assert_says_so_and_lives_on(room: Room, reason: str) -> None:
    """Speak until the disk is full, and see what the recorder makes of it."""
    sentence = f"cannot be written any more: {reason}; what was flushed before is kept"

    def is_full() -> bool:
        for _ in range(5):
            room.speak()
        return bool(room.told) and room.told[-1].level == DiagnosticStatus.ERROR

    room.until(is_full)
    assert sentence in room.told[-1].message
    begun_s, cpu_s, heard, said = time.monotonic(), room.cpu_s, len(room.told), room.said
    room.until(lambda: len(room.told) >= heard + 2)  # counts the words that were said until here
    dropped = int(dropped_words(room.told[-1]))
    for _ in range(10):
        room.speak()
    room.until(lambda: dropped_words(room.told[-1]) == dropped + 10)
    assert sentence in room.told[-1].message
    assert said > dropped > 0
    assert room.cpu_s - cpu_s < 0.5 * (time.monotonic() - begun_s)
    assert (room.folder.parent / "log").read_text().count(sentence) == 1
    kept = words(room.bag)
    assert kept == list(range(len(kept)))
    assert len(kept) * len(word(0)) / 2 > 0.4 * ROOM_BYTES  # hexadecimal digits are compressed to a half
    assert not list(room.bag.glob("*.part"))


def dropped_words(status: DiagnosticStatus) -> int:
    (told,) = [pair.value for pair in status.values if pair.key == "/words"]
    return int(told.removesuffix(" dropped").rpartition(" ")[2])


def test_a_recorder_whose_file_may_not_grow_lives_on(room: Room) -> None:
    room.start()
    assert room.process is not None
    _, most = resource.prlimit(room.process.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(room.process.pid, resource.RLIMIT_FSIZE, (ROOM_BYTES, most))
    assert_says_so_and_lives_on(room, "File too large")
    kept = words(room.bag)
    room.process.send_signal(signal.SIGINT)
    assert room.process.wait(LIMIT_S) == 0
    assert words(room.folder / "run") == kept
    with open_bag(room.folder / "run") as bag:
        assert "was not closed properly" in bag.cut


@pytest.mark.skipif(not mounts_are_permitted(), reason="a small file system cannot be mounted here")
def test_a_recorder_whose_disk_is_full_lives_on(room: Room) -> None:
    mount = f'mount -t tmpfs -o size={ROOM_BYTES} none {room.folder} && exec "$@"'
    room.start(*UNSHARE, "sh", "-c", mount, "sh")
    assert_says_so_and_lives_on(room, "No space left on device")
    assert room.process is not None
    room.process.send_signal(signal.SIGINT)
    assert room.process.wait(LIMIT_S) == 0


def test_a_bag_that_cannot_even_be_begun_is_refused(tmp_path: Path, manifest: Manifest) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, limits[1]))
    try:
        with pytest.raises(BadFileError, match="a bag cannot be written to .*bag: File too large"):
            BagWriter(tmp_path / "bag", manifest=manifest)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
