"""What the recorder stands: how much it takes without loss, and what it costs beside a search (Linux)."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from bags.reader import Bag, open_bag
from bags.recorder_load import NAMESPACE, number_of
from robustnav_msgs_py.errors import BadFileError, GraphError

SAMPLE_S = 0.1
CLOSING_LIMIT_S = 60.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderRow:
    """What one recording took.

    seconds: how long it was heard; mb_per_s, messages_per_s: what came to be in the bag, uncompressed.
    missing: messages that were said on reliable topics and are not in the bag, None where nobody numbered
    them; dropped: what the recorder itself says it dropped. cpu_share: of one core, while it recorded;
    rss_mb: most memory it ever held, shared memory of the middleware included. file_mb: of the bag.
    """

    load: str
    seconds: float
    mb_per_s: float
    messages_per_s: float
    missing: int | None
    dropped: int
    cpu_share: float
    rss_mb: float
    file_mb: float


@dataclass(slots=True)
class _Usage:
    """CPU seconds and memory of a process, as last seen while it lived."""

    pid: int
    cpu_s: float = 0.0
    peak_kb: int = 0

    def look(self) -> bool:
        """False where the process is gone; what was seen before stays."""
        try:
            stat = Path(f"/proc/{self.pid}/stat").read_text(encoding="ascii", errors="replace")
            status = Path(f"/proc/{self.pid}/status").read_text(encoding="ascii", errors="replace")
        except OSError:
            return False
        fields = stat.rpartition(")")[2].split()  # from the third field on: a name may hold blanks
        peak = re.search(r"VmHWM:\s+(\d+) kB", status)
        if peak is None:  # it has ended, and its parent has not noticed yet
            return False
        self.cpu_s = (int(fields[11]) + int(fields[12])) / TICKS_PER_S
        self.peak_kb = int(peak[1])
        return True


def measure_load(folder: Path, *, mb_per_s: float, messages_per_s: float, seconds: float) -> RecorderRow:
    """Record a load of numbered messages into the new bag `folder`, in a process of its own, and count.

    Raises GraphError where the recorder or the load does not come to its end, BadFileError where the bag
    cannot be made or read.
    """
    with _recorder(folder) as recorder:
        usage = _Usage(recorder.pid)
        words = [str(number) for number in (mb_per_s, messages_per_s, seconds)]
        command = [sys.executable, "-m", "bags.recorder_load", *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as load:
            usage.look()
            before_s = usage.cpu_s
            while load.poll() is None and usage.look():
                time.sleep(SAMPLE_S)
            told = load.stdout.read() if load.stdout else ""
        if load.returncode != 0:
            raise GraphError(f"the load for the recorder left with code {load.returncode}")
    report = json.loads(told)
    with open_bag(folder) as bag:
        row = _row_of(
            bag,
            load="images and odometry",
            prefix=NAMESPACE,
            seconds=float(report["seconds"]),
            missing=_missing(bag, report["said"]),
            usage=usage,
            cpu_s=usage.cpu_s - before_s,
        )
    return row


def measure_demo(folder: Path, *, seed: int) -> RecorderRow:
    """Run `robustnav demo` recorded into the new bag `folder`, and see what its recorder took.

    Raises GraphError where no recorder is seen, BadFileError where there is no bag then.
    """
    command = [sys.executable, "-m", "robustnav_nodes", "demo", "--seed", str(seed), "--bag", str(folder)]
    usage: _Usage | None = None
    before_s, begun_s, ended_s = 0.0, 0.0, 0.0
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as demo:
        while demo.poll() is None:
            if usage is None and any(folder.glob("*.mcap")):
                pid = _descendant(demo.pid, "recorder")
                usage = _Usage(pid) if pid is not None else None
                if usage is not None and usage.look():
                    before_s, begun_s = usage.cpu_s, time.monotonic()
            elif usage is not None and usage.look():
                ended_s = time.monotonic()
            time.sleep(SAMPLE_S)
    if usage is None or ended_s <= begun_s:
        raise GraphError(f"no recorder was seen in the demo with seed {seed}; it left with {demo.returncode}")
    with open_bag(folder) as bag:
        return _row_of(
            bag,
            load=f"demo, seed {seed}",
            prefix="",
            seconds=ended_s - begun_s,
            missing=None,
            usage=usage,
            cpu_s=usage.cpu_s - before_s,
        )


def _row_of(
    bag: Bag, *, load: str, prefix: str, seconds: float, missing: int | None, usage: _Usage, cpu_s: float
) -> RecorderRow:
    messages, size_bytes = 0, 0
    for raw in bag.raw_messages([row.name for row in bag.topics if row.name.startswith(prefix)]):
        messages += 1
        size_bytes += len(raw.data)
    return RecorderRow(
        load=load,
        seconds=round(seconds, 2),
        mb_per_s=round(size_bytes / seconds / 1e6, 2),
        messages_per_s=round(messages / seconds, 1),
        missing=missing,
        dropped=_dropped(bag),
        cpu_share=round(cpu_s / seconds, 3),
        rss_mb=round(usage.peak_kb * 1024 / 1e6, 1),
        file_mb=round(bag.size_bytes / 1e6, 1),
    )


def _missing(bag: Bag, said: dict[str, int]) -> int:
    """Messages of the load that the bag lacks, plus those that it holds twice."""
    heard = Counter((raw.topic, number_of(raw.data)) for raw in bag.raw_messages(list(said)))
    expected = {(topic, number) for topic, count in said.items() for number in range(count)}
    return len(expected - heard.keys()) + sum(count - 1 for count in heard.values())


def _dropped(bag: Bag) -> int:
    """What the recorder told last of the messages that it dropped."""
    told = 0
    for recorded in bag.messages(["/diagnostics"]):
        for status in recorded.message.status:
            if status.name.endswith("/recorder"):
                told = next((int(pair.value) for pair in status.values if pair.key == "dropped"), told)
    return told


@contextmanager
def _recorder(folder: Path) -> Iterator["subprocess.Popen[bytes]"]:
    """A recorder in a process of its own that hears the load and itself, until the block ends."""
    if folder.exists():
        raise BadFileError(f"{folder} exists already and is not overwritten; choose another name")
    parameters = {
        "folder": folder.parent,
        "name": folder.name,
        "include": f"{NAMESPACE}/.*|/diagnostics",
    }
    given = [part for name, value in parameters.items() for part in ("-p", f"{name}:={value}")]
    command = [sys.executable, "-m", "robustnav_nodes", "run", "bags", "recorder", "--ros-args", *given]
    with subprocess.Popen(command) as process:
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(CLOSING_LIMIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
    if process.returncode != 0:
        raise GraphError(f"the recorder left with code {process.returncode}")


def _descendant(root: int, word: str) -> int | None:
    """A process below `root` that has `word` among its arguments."""
    parents: dict[int, int] = {}
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            stat = (entry / "stat").read_text(encoding="ascii", errors="replace")
            arguments = (entry / "cmdline").read_bytes().split(b"\0")
        except OSError:  # it has just ended
            continue
        parents[int(entry.name)] = int(stat.rpartition(")")[2].split()[1])
        if word.encode() in arguments:
            found.append(int(entry.name))
    for pid in found:
        above = pid
        while above in parents and above != root:
            above = parents[above]
        if above == root:
            return pid
    return None
