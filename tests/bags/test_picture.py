from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import colors, image

from bags.definitions import message_definition
from bags.manifest import Manifest
from bags.picture import draw_search
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.drawing.colors import FALSE_ALARM, TARGET


def drawn(bag_path: Path, png: Path) -> np.ndarray:
    with open_bag(bag_path) as bag:
        draw_search(bag, png)
    return image.imread(png)


def has_color(pixels: np.ndarray, color: str) -> bool:
    return bool((np.abs(pixels[:, :, :3] - colors.to_rgb(color)).max(axis=2) < 0.02).any())


def test_a_search_is_drawn_with_what_it_was_fooled_by(
    search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    pixels = drawn(search_bag(), tmp_path / "a.png")
    assert pixels.shape[1] == pytest.approx(1536, abs=2)
    assert has_color(pixels, TARGET)
    assert has_color(pixels, FALSE_ALARM)


def test_a_search_without_false_alarms_shows_none(
    search_bag: Callable[..., Path], corridor: Any, tmp_path: Path
) -> None:
    pixels = drawn(search_bag(corridor.flat, corridor.told), tmp_path / "a.png")
    assert not has_color(pixels, FALSE_ALARM)


def test_a_name_with_signs_of_mathematics_is_drawn_as_it_is(
    search_bag: Callable[..., Path], corridor: Any, tmp_path: Path
) -> None:
    objects = [replace(item, label="$\\frac{$") for item in corridor.flat.objects]
    told = replace(corridor.told, target="$\\frac{$")
    drawn(search_bag(replace(corridor.flat, objects=objects), told), tmp_path / "a.png")


def test_a_map_alone_can_be_drawn(
    tmp_path: Path, manifest: Manifest, search_bag: Callable[..., Path]
) -> None:
    with open_bag(search_bag()) as bag:
        (raw,) = bag.raw_messages(["/map"])
    with BagWriter(tmp_path / "map", manifest=manifest) as writer:
        channel = writer.add_topic("/map", message_definition(raw.type, ()))
        writer.write(channel, log_time_ns=1, publish_time_ns=1, data=raw.data)
    drawn(tmp_path / "map", tmp_path / "a.png")


def test_a_bag_without_a_map_cannot_be_drawn(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "none", manifest=manifest) as writer:
        channel = writer.add_topic("/search/target", message_definition("std_msgs/msg/String", ()))
        writer.write(channel, log_time_ns=10, publish_time_ns=10, data=b"\0\1\0\0\4\0\0\0mug\0")
    with pytest.raises(BadFileError, match="no map was recorded"):
        drawn(tmp_path / "none", tmp_path / "a.png")


def test_a_picture_that_cannot_be_written_is_said(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="cannot be written"):
        drawn(search_bag(), tmp_path / "nowhere" / "a.png")
