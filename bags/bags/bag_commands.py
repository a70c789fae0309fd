"""`robustnav bag`: look into recorded runs, measure them, and make them fit to be kept and shared.

Needs no ROS. What a command stands on is imported in it: `robustnav --help` waits for none of it.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from bags.redaction_choices import Chat, Images
from robustnav_msgs_py.errors import BadFileError, BadParameterError, GraphError, RobustnavError

if TYPE_CHECKING:
    from bags.metrics_table import MetricsRow
    from robustnav_nodes.benchmarks.detection_tally import Tally

bag_app = typer.Typer(help="Look into recorded runs, measure, repair and share them.", no_args_is_help=True)

PIPE_WIDTH = 160
BagPath = Annotated[Path, typer.Argument(metavar="BAG", help="folder of a bag, or an .mcap file")]


@bag_app.command("info")
def bag_info_command(bag: BagPath) -> None:
    """What a bag holds: topics, counts, rates, QoS, and the manifest of its run."""
    from bags.info import bag_info, render
    from bags.reader import open_bag

    with open_bag(bag) as opened:
        _console().print(render(bag_info(opened)))


@bag_app.command("metrics")
def metrics_command(
    bags: Annotated[list[Path], typer.Argument(metavar="BAG...", help="folders of bags, or .mcap files")],
    json_file: Annotated[
        Path | None, typer.Option("--json", help="file for the figures; one that is there is replaced")
    ] = None,
) -> None:
    """How well the robot searched: a row for each search, and the means over all."""
    from bags.metrics_table import metrics_rows, render, report_content
    from bags.reader import open_bag
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report

    check_writable(json_file)
    rows: list[MetricsRow] = []
    problems: list[RobustnavError] = []
    for path in bags:
        try:
            with open_bag(path) as opened:
                rows += metrics_rows(opened)
        except RobustnavError as error:  # the others may be whole
            problems.append(error)
    if rows:
        _console().print(render(rows))
        if json_file is not None:
            write_report(json_file, "bag metrics", **report_content(rows))
    if problems:
        raise BadFileError("; ".join(str(problem) for problem in problems))


@bag_app.command("detection")
def detection_command(
    bags: Annotated[
        list[Path],
        typer.Argument(metavar="BAG...", help="bags with ground truth, of one detector, or .mcap files"),
    ],
    statistics: Annotated[
        Path | None, typer.Option(help="write the file that belief and planner read")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="folder to draw reliability and recall into")] = None,
    robot: Annotated[str | None, typer.Option(help="namespace, where a bag is of several robots")] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="file for the figures; one that is there is replaced")
    ] = None,
) -> None:
    """How good the detector was: by class and distance, and whether its scores are worth what they say."""
    from bags.detection_metrics import detection_figures
    from bags.reader import open_bag
    from robustnav_nodes.benchmarks.detection_plots import draw
    from robustnav_nodes.benchmarks.detection_report import tally_content
    from robustnav_nodes.benchmarks.detection_statistics_file import write_statistics
    from robustnav_nodes.benchmarks.detection_table import class_table, recall_sentence
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report

    check_writable(json_file, statistics)
    if plots is not None and not plots.is_dir():
        raise BadParameterError(f"--plots {str(plots)!r} is no folder; make it first")
    tally: Tally | None = None
    for path in bags:
        with open_bag(path) as opened:
            tally = detection_figures(opened, namespace=robot, into=tally)
    assert tally is not None  # typer asks for one bag at least
    _console().print(f"{tally.images} images")
    _console().print(class_table(tally, with_all=True))
    _say(recall_sentence(tally))
    if statistics is not None:
        write_statistics(statistics, tally)
        _say(f"wrote {statistics}")
    if plots is not None:
        draw({"recorded": tally}, plots)
        _say(f"wrote reliability.png and recall_over_distance.png in {plots}")
    if json_file is not None:
        write_report(json_file, "bag detection", **tally_content(tally))


@bag_app.command("replay")
def replay_command(
    bag: BagPath,
    node: Annotated[
        list[str] | None, typer.Option(help="detection, belief, planner or dialogue; default: all four")
    ] = None,
    params: Annotated[
        Path | None, typer.Option(help="ROS parameter file (YAML) over the recorded parameters")
    ] = None,
) -> None:
    """Feed what was recorded to the real nodes, in lock-step, and compare what they say now. Needs ROS."""
    _replay(bag, tuple(node or ()), params)


@bag_app.command("verify")
def verify_command(bag: BagPath) -> None:
    """Replay with the recorded parameters; exit code 1 unless every message comes again, the same."""
    if not _replay(bag, (), None):
        raise typer.Exit(1)


@bag_app.command("report")
def report_command(
    bag: BagPath,
    out: Annotated[Path | None, typer.Option(help="page to write; default: beside the bag, BAG.html")] = None,
    png: Annotated[Path | None, typer.Option(help="write a picture of the search, too")] = None,
    episode: Annotated[
        int | None, typer.Option(min=0, help="number of the search; default: the last one")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="namespace, where the bag is of several robots")] = None,
) -> None:
    """Write one page that shows a search over time; it opens anywhere and asks nothing of any network."""
    from bags.picture import draw_search
    from bags.reader import open_bag
    from bags.report_data import read_report
    from bags.report_file import write_report_page
    from robustnav_nodes.benchmarks.report_file import check_writable

    page = out or bag.parent / f"{bag.name.removesuffix('.mcap') or 'report'}.html"
    check_writable(page, png)
    with open_bag(bag) as opened:
        write_report_page(read_report(opened, namespace=robot, episode=episode), page)
        _say(f"wrote {page}")
        if png is not None:
            draw_search(opened, png, namespace=robot, episode=episode)
            _say(f"wrote {png}")


@bag_app.command("repair")
def repair_command(
    bag: BagPath,
    out: Annotated[
        Path | None, typer.Option(help="new folder for the repaired bag; default: repair it in its place")
    ] = None,
) -> None:
    """Give a bag whose recorder was killed a proper end, and say what was lost."""
    from bags.repair_bag import repair_bag

    with _disk_failures(out or bag):
        for sentence in repair_bag(bag, out).sentences:
            _say(sentence)


@bag_app.command("redact")
def redact_command(
    bag: BagPath,
    out: Annotated[Path, typer.Option(help="new folder for the redacted bag")],
    images: Annotated[Images, typer.Option(help="what becomes of images")] = Images.REMOVE,
    chat: Annotated[Chat, typer.Option(help="what becomes of what was said")] = Chat.REMOVE,
) -> None:
    """Write a bag that can be shared: without images and without what people said to the robot."""
    from bags.redact import redact_bag

    with _disk_failures(out):
        done = redact_bag(bag, out, images=images, chat=chat)
    for sentence in done.sentences:
        _say(sentence)
    _say(f"wrote {out}; map, places, times and the parameters of the nodes are in it as they were")


@contextmanager
def _disk_failures(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise BadFileError(f"{path} could not be written: {error.strerror or error}") from error


def _console() -> Console:
    """As wide as the terminal; wide enough for every table where another program reads."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else PIPE_WIDTH)


def _say(line: str) -> None:
    Console(highlight=False, soft_wrap=True).print(escape(line))


def _replay(path: Path, nodes: tuple[str, ...], params: Path | None) -> bool:
    """Replay and show what came of it; whether all was the same."""
    from bags.reader import open_bag

    try:
        from bags.replay import replay
        from bags.replay_table import render
    except ModuleNotFoundError as error:
        raise GraphError(
            f"the nodes need ROS 2, which is not here ({error}): source it, or pip install 'robustnav[ros]'"
        ) from error
    with open_bag(path) as opened:
        result = replay(opened, nodes=nodes, parameter_file=params)
        span = opened.span_ns
    _console().print(render(result, span[0] if span is not None else 0), soft_wrap=True)
    return result.is_same
