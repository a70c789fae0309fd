"""The same graph in one process: `robustnav up --one-process`, for small computers."""

import signal
import subprocess
import sys
from pathlib import Path

from bags.reader import open_bag
from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.records import SearchPhase, SearchState
from tests.bench import Bench

DEADLINE_S = 60.0


def test_a_search_in_one_process(bench: Bench, tmp_path: Path) -> None:
    params = tmp_path / "params.yaml"
    params.write_text(
        "sim_bridge: {ros__parameters: {real_time_factor: 5.0, difficulty: easy}}\n"
        "detection: {ros__parameters: {recall: 1.0, precision: 1.0}}\n"
        "simulated_user: {ros__parameters: {target: guitar}}\n",
        encoding="utf-8",
    )
    bag = tmp_path / "bag"
    states = bench.hear("search/state")
    command = [sys.executable, "-m", "robustnav_nodes", "up", "--one-process", "--user", "simulated"]
    command += ["--seed", "2", "--bag", str(bag), "--params", str(params)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:

        def found() -> bool:
            last = wire.record_from_message(states[-1], SearchState) if states else SearchState()
            return last.phase is SearchPhase.FOUND

        bench.wait(found, "the guitar to be found", timeout_s=DEADLINE_S)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=DEADLINE_S)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == 0, output
    with open_bag(bag) as opened:
        assert not opened.cut
        assert any(topic.name == "/planner/decision" and topic.message_count for topic in opened.topics)
