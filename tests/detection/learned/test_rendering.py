"""The pictures show what their table says, and the same plan gives the same pictures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.detection.learned.rendering import Kind, RenderPlan, render_pictures
from robustnav_nodes.detection.learned.training_pictures import (
    OBJECTS_FILE,
    PIXELS_FILE,
    PictureSet,
    load_pictures,
)


def test_pictures_show_objects_inside_of_them(pictures: PictureSet) -> None:
    table = pictures.objects
    assert pictures.pixels.shape == (24, 240, 320, 3)
    assert len(table) > 24
    assert (np.diff(table.picture) >= 0).all()
    assert (table.box_px[:, :2] >= 0.0).all()
    assert (table.box_px[:, 2:] <= (320.0, 240.0)).all()
    assert (table.box_px[:, 2:] > table.box_px[:, :2]).all()


def test_no_object_covers_more_than_its_box_or_shows_more_than_itself(pictures: PictureSet) -> None:
    table = pictures.objects
    area = np.prod(table.box_px[:, 2:] - table.box_px[:, :2], axis=1)
    assert (table.visible_px <= area).all()
    assert (table.visible_fraction > 0.0).all()
    assert (table.visible_fraction <= 1.0).all()
    assert (table.ahead_m <= table.distance_m + 1e-5).all()


def test_rows_of_a_picture_are_its_own(pictures: PictureSet) -> None:
    rows = [pictures.objects.rows_of(number) for number in range(len(pictures))]
    assert sum(own.stop - own.start for own in rows) == len(pictures.objects)
    assert all((pictures.objects.picture[own] == number).all() for number, own in enumerate(rows))


@pytest.mark.parametrize("kind", [Kind.TEST, Kind.LOOK_ALIKES])
def test_the_same_plan_gives_the_same_pictures(tmp_path: Path, kind: Kind) -> None:
    plan = RenderPlan(kind=kind, first_seed=90_100, homes=1, per_home=3)
    first, second = (render_pictures(plan, tmp_path / name, 1) for name in ("first", "second"))
    assert np.array_equal(first.pixels, second.pixels)
    assert np.array_equal(first.objects.box_px, second.objects.box_px)


def test_pictures_of_another_plan_or_look_are_refused(tmp_path: Path) -> None:
    plan = RenderPlan(kind=Kind.TEST, first_seed=90_300, homes=1, per_home=2)
    folder = tmp_path / "pictures"
    first = render_pictures(plan, folder, 1)
    assert np.array_equal(render_pictures(plan, folder, 1).pixels, first.pixels)
    for other in (
        replace(plan, first_seed=90_301),
        replace(plan, homes=2),
        replace(plan, kind=Kind.TRAINING),
    ):
        with pytest.raises(BadFileError, match="as they are rendered now; remove the folder"):
            render_pictures(other, folder, 1)
    pixels = np.load(folder / PIXELS_FILE)
    np.save(folder / PIXELS_FILE, 255 - pixels)
    with pytest.raises(BadFileError, match="remove the folder"):
        render_pictures(plan, folder, 1)


def test_look_alikes_are_what_the_pictures_look_at(tmp_path: Path) -> None:
    plan = RenderPlan(kind=Kind.LOOK_ALIKES, first_seed=90_200, homes=1, per_home=6)
    seen = render_pictures(plan, tmp_path / "pictures", 1)
    mugs = np.unique(seen.objects.picture[seen.objects.label == seen.labels.index("mug")])
    assert len(mugs) >= 5


def test_pictures_without_their_table_are_refused(tmp_path: Path) -> None:
    np.save(tmp_path / PIXELS_FILE, np.zeros((1, 2, 2, 3), dtype=np.uint8))
    with pytest.raises(BadFileError, match="render them anew"):
        load_pictures(tmp_path)
    (tmp_path / OBJECTS_FILE).write_bytes(b"PK not a zip")
    with pytest.raises(BadFileError, match="render them anew"):
        load_pictures(tmp_path)
