"""What killed processes left in shared memory goes; what is in use stays."""

import mmap
import os
from pathlib import Path

import pytest

from robustnav_nodes.graph import shared_memory


def test_orphaned_ports_go_and_those_in_use_or_young_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shared_memory, "SHM", tmp_path)
    monkeypatch.setattr(shared_memory.shutil, "which", lambda *_, **__: None)
    names = ("fastrtps_port11", "fastrtps_port12", "fastrtps_port13", "fastrtps_port14", "something_else")
    for name in (*names, "fastrtps_port12_el", "sem.fastrtps_port11_mutex"):
        (tmp_path / name).write_bytes(b"x" * 4096)
        os.utime(tmp_path / name, (1.0, 1.0))
    os.utime(tmp_path / "fastrtps_port14")
    with (tmp_path / "fastrtps_port13").open("r+b") as used, mmap.mmap(used.fileno(), 0):
        shared_memory.clean_shared_memory()
    left = {item.name for item in tmp_path.iterdir()}
    assert left == {
        "fastrtps_port12",
        "fastrtps_port12_el",
        "fastrtps_port13",
        "fastrtps_port14",
        "something_else",
    }
