import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

SCRIPT = textwrap.dedent(
    """
    import sys
    sys.modules["rclpy"] = None  # importing it raises ImportError
    from pathlib import Path
    from bags.info import bag_info, render
    from bags.metrics import search_metrics
    from bags.picture import draw_search
    from bags.reader import open_bag

    with open_bag(Path(sys.argv[1])) as bag:
        render(bag_info(bag))
        assert search_metrics(bag).success
        draw_search(bag, Path(sys.argv[2]))
    """
)


def test_a_bag_is_read_measured_and_drawn_where_rclpy_is_missing(
    search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    subprocess.run([sys.executable, "-c", SCRIPT, str(search_bag()), str(tmp_path / "a.png")], check=True)
    assert (tmp_path / "a.png").stat().st_size > 10_000
