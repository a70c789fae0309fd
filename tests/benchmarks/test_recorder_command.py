import json

import pytest
from typer.testing import CliRunner

from bags import recorder_bench
from bags.recorder_bench import RecorderRow
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.bench_commands import bench_app


def row(load, missing):
    return RecorderRow(
        load=load,
        seconds=30.0,
        mb_per_s=62.2,
        messages_per_s=3064.1,
        missing=missing,
        dropped=7,
        cpu_share=0.344,
        rss_mb=129.2,
        file_mb=602.0,
    )


@pytest.fixture
def asked(monkeypatch):
    """What the command asks to be measured; nothing is."""
    calls = []

    def measure_load(folder, **wanted):
        calls.append((folder, wanted))
        return row("images and odometry", 7)

    def measure_demo(folder, **wanted):
        calls.append((folder, wanted))
        return row("demo", None)

    monkeypatch.setattr(recorder_bench, "measure_load", measure_load)
    monkeypatch.setattr(recorder_bench, "measure_demo", measure_demo)
    return calls


def test_the_report_holds_what_was_measured_and_with_which_settings(asked, tmp_path):
    json_file = tmp_path / "recorder.json"
    done = CliRunner().invoke(bench_app, ["recorder", "--mb-per-s", "60", "--json", str(json_file)])
    assert done.exit_code == 0, done.output
    (load_bag, load), (demo_bag, demo) = asked
    assert load == {"mb_per_s": 60.0, "messages_per_s": 3000.0, "seconds": 30.0}
    assert demo == {"seed": 1}
    assert load_bag.parent == demo_bag.parent
    assert not load_bag.parent.exists()  # where nobody asked to keep the bags
    report = json.loads(json_file.read_text())
    assert report["bench"] == "recorder"
    assert report["settings"] == load
    assert [told["missing"] for told in report["rows"]] == [7, None]
    assert report["rows"][0].keys() == set(RecorderRow.__dataclass_fields__)
    assert "34%" in done.output


def test_bags_are_kept_where_that_is_asked_for(asked, tmp_path):
    done = CliRunner().invoke(bench_app, ["recorder", "--no-demo", "--bags", str(tmp_path / "kept")])
    assert done.exit_code == 0, done.output
    assert [folder for folder, _ in asked] == [tmp_path / "kept" / "load"]


def test_a_report_that_cannot_be_written_is_refused_before_anything_is_measured(asked, tmp_path):
    done = CliRunner().invoke(bench_app, ["recorder", "--json", str(tmp_path / "nowhere" / "a.json")])
    assert isinstance(done.exception, BadFileError)
    assert asked == []
