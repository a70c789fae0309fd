"""Processes that work for a command end with it."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from robustnav_nodes.worker_pool import worker_pool

BUSY = """
import time
from robustnav_nodes.worker_pool import worker_pool

def work(seconds):
    print("at work", flush=True)
    time.sleep(seconds)

if __name__ == "__main__":
    with worker_pool(2) as pool:
        list(pool.map(work, [1000.0] * 8))
"""


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_they_end_with_their_command_in_the_middle_of_a_job(tmp_path: Path, end: signal.Signals) -> None:
    script = tmp_path / "busy.py"
    script.write_text(BUSY)
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, script], stdout=pipe, stderr=pipe, text=True) as command:
        assert command.stdout is not None
        for _ in range(2):
            assert command.stdout.readline() == "at work\n"
        command.send_signal(end)
        command.communicate(timeout=60.0)  # at its end nobody holds the other end of the pipe
    assert command.returncode != 0


def test_an_error_stops_them_in_the_middle_of_a_job() -> None:
    def fail_beside_it() -> None:
        with worker_pool(1) as pool:
            pool.submit(time.sleep, 1000.0)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_beside_it()


def test_each_is_prepared_before_its_first_job(tmp_path: Path) -> None:
    with worker_pool(1, partial(os.chdir, tmp_path)) as pool:
        assert Path(pool.submit(os.getcwd).result()) == tmp_path


def test_ctrl_c_is_the_commands() -> None:
    with worker_pool(1) as pool:
        pid = pool.submit(os.getpid).result()
        os.kill(pid, signal.SIGINT)
        assert pool.submit(os.getpid).result() == pid
