"""The simulator's benchmark writes the figures that scripts read, and measures one core."""

import json
import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from robustnav_nodes.benchmarks.bench_commands import bench_app

pytest.importorskip("pybullet")


def test_the_report_has_its_keys_and_the_core_is_given_back(tmp_path: Path) -> None:
    cores = os.sched_getaffinity(0)
    report = tmp_path / "sim.json"
    result = CliRunner().invoke(bench_app, ["sim", "--seed", "2", "--homes", "2", "--json", str(report)])
    assert result.exit_code == 0, result.output
    assert os.sched_getaffinity(0) == cores
    figures = json.loads(report.read_text(encoding="utf-8"))
    assert figures["bodies"] >= 150
    for key in (
        "rgbd_320x240_fps",
        "rgbd_640x480_fps",
        "lockstep_realtime_factor",
        "hard_home_build_s",
        "rss_mb",
    ):
        assert figures[key] > 0.0, key
