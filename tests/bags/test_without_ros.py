"""Bags are looked into, measured, drawn, redacted and repaired where nothing of ROS is installed."""

import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

SCRIPT = textwrap.dedent(
    """
    import sys
    from pathlib import Path

    class NoRos:  # wherever it may be installed
        def find_spec(self, name, path, target=None):
            package = name.partition(".")[0]
            if package.endswith(("_msgs", "_srvs", "_interfaces")) or package in ("rclpy", "rpyutils"):
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    sys.meta_path.insert(0, NoRos())
    from bags.info import bag_info, render
    from bags.metrics import search_metrics
    from bags.metrics_table import metrics_rows, render as render_metrics
    from bags.picture import draw_search
    from bags.reader import open_bag
    from bags.redact import redact_bag
    from bags.redaction_choices import Chat, Images
    from bags.repair_bag import repair_bag
    from bags.report_data import read_report
    from bags.report_file import write_report_page
    from robustnav_msgs_py.errors import GraphError
    from robustnav_nodes.cli import command_line

    with open_bag(Path(sys.argv[1])) as bag:
        render(bag_info(bag))
        assert search_metrics(bag).success
        draw_search(bag, Path(sys.argv[2]))
        render_metrics(metrics_rows(bag))
        write_report_page(read_report(bag), Path(sys.argv[2]).with_suffix(".html"))
    shared = Path(sys.argv[2]).parent / "shared"
    redact_bag(Path(sys.argv[1]), shared, images=Images.REMOVE, chat=Chat.REMOVE)
    repair_bag(shared)
    command_line()(["bag", "info", str(shared)], standalone_mode=False)
    try:
        command_line()(["bag", "verify", str(shared)], standalone_mode=False)
    except GraphError as error:
        assert "pip install 'robustnav[ros]'" in str(error)
    else:
        raise AssertionError("nodes cannot be run without ROS")
    """
)


def test_a_bag_is_read_measured_and_drawn_without_ros(
    search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    subprocess.run([sys.executable, "-c", SCRIPT, str(search_bag()), str(tmp_path / "a.png")], check=True)
    assert (tmp_path / "a.png").stat().st_size > 10_000
