import json
import os
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes import cli
from robustnav_nodes.benchmarks import pomdp_returns
from robustnav_nodes.benchmarks.bench_commands import bench_app
from robustnav_nodes.benchmarks.pomdp_returns import MeanReturn
from robustnav_nodes.benchmarks.report_file import write_report
from robustnav_nodes.benchmarks.search_bench import Gain, SearchRow

EASY = ("search", "--suite", "easy-noisy", "--episodes", "12", "--planners", "random,greedy,lookahead")


@pytest.fixture(scope="module")
def bench():
    """Runs `robustnav bench ...` here; errors come through, as they do to the command line's own handler."""

    def run(*arguments):
        result = CliRunner().invoke(bench_app, [str(argument) for argument in arguments])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return run


def robustnav(*arguments):
    """The command in a process of its own: multiprocessing keeps one until the command ends."""
    return subprocess.run(
        [sys.executable, "-m", "robustnav_nodes", "bench", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "COLUMNS": "120"},
    )


@pytest.fixture(scope="module")
def easy(bench, tmp_path_factory):
    """A folder with the report and the pictures of a short search bench, and what it showed."""
    folder = tmp_path_factory.mktemp("easy")
    shown = bench(
        *EASY, "--workers", "1", "--json", folder / "report.json", "--plots", folder / "made"
    ).output
    return folder, shown


def figures(path):
    rows = json.loads(path.read_text())["rows"]
    return [{name: value for name, value in row.items() if "_ms_" not in name} for row in rows]


def test_the_number_of_processes_changes_nothing(easy, tmp_path):
    here, elsewhere = easy[0] / "report.json", tmp_path / "elsewhere.json"
    done = robustnav(*EASY, "--workers", "2", "--json", elsewhere)
    assert (done.returncode, done.stderr) == (0, "")
    assert figures(here) == figures(elsewhere)


def test_the_report_is_as_written_down(easy):
    """BENCHMARKS.md: scripts depend on these names."""
    folder, shown = easy
    report = json.loads((folder / "report.json").read_text())
    assert report["bench"] == "search"
    assert report["suite"] == "easy-noisy"
    assert (report["seed"], report["episodes"], report["default_planner"]) == (1, 12, "lookahead")
    assert report.keys() >= {"version", "commit", "settings"}
    assert [row["planner"] for row in report["rows"]] == ["random", "greedy", "lookahead"]
    assert all(row.keys() == set(SearchRow.__slots__) for row in report["rows"])
    assert all(row["decision_ms_p95"] >= row["decision_ms_p50"] > 0.0 for row in report["rows"])
    (gain,) = report["gains"]
    assert gain.keys() == set(Gain.__slots__)
    assert (gain["over"], gain["difficulty"], gain["detector"]) == ("greedy", "easy", "noisy")
    assert report["settings"]["destination_m"] == 0.5
    for words in ("easy, noisy detector", "12 episodes", "thesis, AVDB: other data", "lookahead over greedy"):
        assert words in shown, shown
    assert max(len(line) for line in shown.splitlines()) <= 80


def test_a_report_is_replaced_whole(tmp_path):
    path = tmp_path / "a.json"
    path.write_text("an earlier one")
    with pytest.raises(ValueError):  # JSON has no NaN
        write_report(path, "search", rows=[float("nan")])
    assert path.read_text() == "an earlier one"
    write_report(path, "search", rows=[])
    assert json.loads(path.read_text())["rows"] == []
    assert list(tmp_path.iterdir()) == [path]


def test_pictures_are_drawn(easy):
    assert (easy[0] / "made" / "spl_by_length.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("search", "--suite", "hard"), "no suite 'hard'"),
        (("search", "--planners", "astar"), "no planner 'astar'"),
        (("search", "--planners", "pomp,pomp"), "once"),
        (("search", "--planners", ""), "no planner ''"),
        (("search", "--suite", "all", "--scenes", "."), "one of the two"),
        (("search", "--target-id", "1"), "name the folder"),
        (("search", "--episodes", "0"), "nothing to do"),
        (("search", "--scenes", "/nowhere"), "no scene file"),
        (("search", *EASY[1:], "--ray", "auto"), "robustnav\\[cluster\\]"),
        (("planner", "--sizes", "100,many"), "'100,many'"),
        (("planner", "--sizes", "1"), "numbers from"),
    ],
)
def test_wrong_usage_is_a_sentence(bench, arguments, says):
    with pytest.raises(BadParameterError, match=says):
        bench(*arguments)


@pytest.mark.parametrize(
    "arguments",
    [
        ("search", "--episodes", "-1"),
        ("search", "--workers", "0"),
        ("search", "--simulations", "many"),
        ("pomdp", "--episodes", "1"),
        ("nothing",),
    ],
)
def test_what_the_command_line_refuses_exits_with_2(bench, arguments):
    assert bench(*arguments).exit_code == 2


@pytest.mark.parametrize("name", ["search", "planner", "pomdp"])
def test_a_file_that_cannot_be_written_is_refused_before_the_work(bench, tmp_path, name):
    with pytest.raises(BadFileError, match="cannot write"):
        bench(name, "--json", tmp_path / "nowhere" / "a.json")
    with pytest.raises(BadFileError, match="is a folder"):
        bench(name, "--json", tmp_path)


def test_a_damaged_scene_ends_the_command_with_a_sentence(tmp_path):
    for name in ("a.npz", "b.npz"):
        (tmp_path / name).write_bytes(b"no scene")
    done = robustnav("search", "--scenes", tmp_path, "--workers", "2", "--planners", "random")
    assert done.returncode == 1
    assert done.stderr.startswith("robustnav: the scene file ")
    assert done.stderr.count("\n") == 1


def test_a_folder_without_scenes_exits_with_2(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["robustnav", "bench", "search", "--scenes", str(tmp_path)])
    monkeypatch.setattr("signal.signal", lambda *_: None)
    assert cli.main() == 2
    assert capsys.readouterr().err.startswith("robustnav: there is no scene file")


def test_pomcp_is_set_beside_what_is_published(bench, tmp_path, monkeypatch):
    """Measuring it is tested elsewhere, and takes long."""

    def measured(*_arguments, episodes=4, **_more):
        return MeanReturn(mean=19.0, standard_error=0.5, episodes=episodes)

    monkeypatch.setattr(pomdp_returns, "tiger_return", measured)
    monkeypatch.setattr(pomdp_returns, "rocksample_return", measured)
    path = tmp_path / "a.json"
    shown = bench("pomdp", "--simulations", 64, "--episodes", 4, "--json", path).output
    assert "20.71" in shown
    rows = json.loads(path.read_text())["rows"]
    assert [row["problem"] for row in rows] == ["Tiger", "RockSample[7,8]"]
    assert all(row["episodes"] == 4 and row["mean"] == 19.0 for row in rows)


def test_planner_sizes(bench, tmp_path):
    path, png = tmp_path / "a.json", tmp_path / "a.png"
    bench("planner", "--sizes", "100,300", "--seed", "3", "--json", path, "--plot", png)
    report = json.loads(path.read_text())
    assert report["bench"] == "planner"
    assert [row["poses"] < 200 for row in report["rows"]] == [True, False]
    for row in report["rows"]:
        assert 0.0 < row["decision_ms_p50"] <= row["decision_ms_p95"]
        assert row["lookahead_ms_p50"] > 0.0
        assert row["simulated_steps_per_s"] > row["simulations_per_s"] > 0.0
        assert row["belief_update_ms"] > 0.0
        assert row["search_space_s"] > 0.0
        assert row["rss_mb"] > 50.0
    assert png.exists()
