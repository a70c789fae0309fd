"""The columns of sides are counted from the side that was said: the mirror image has the same ones."""

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER
from robustnav_nodes.instruction.mention_features.columns import Columns, Told, Walked
from robustnav_nodes.instruction.mention_features.direction_columns import add_directions
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.place_model import expected_at
from robustnav_nodes.instruction.scene import Scene, scene_of
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import SeenObject, Trajectory, Viewpoint
from tests.instruction.small_world import in_mirror

TEXT = (
    "turn left , walk to the right of the couch and take the leftmost door . stop with the bed on your left"
)
COUCH = SeenObject(name="couch", bearing_rad=0.5, range_m=1.5)
DOORS = tuple(SeenObject(name="door", bearing_rad=bearing, range_m=2.0) for bearing in (0.7, -0.4))
BED = SeenObject(name="bed", bearing_rad=0.9, range_m=2.0)


def crooked_walk() -> Scene:
    places = ((0.0, 0.0, 0.0), (1.0, 0.6, 0.5), (2.5, 0.4, -0.1), (3.0, 2.0, 1.3))
    seen = ((COUCH,), (COUCH, *DOORS), DOORS, (BED,))
    return scene_of(
        Trajectory(
            viewpoints=tuple(
                Viewpoint(x_m=x, y_m=y, z_m=0.0, yaw_in_rad=yaw, yaw_out_rad=yaw + 0.3, objects=objects)
                for (x, y, yaw), objects in zip(places, seen, strict=True)
            )
        )
    )


def columns_of(scene: Scene, text: str) -> dict[str, Float64]:
    tokens = tokenized(text)
    mentions = find_mentions(tokens)
    numbers = np.array([CONCEPT_NUMBER[m.kind, m.concept] for m in mentions])
    said = Told(tokens=tokens, mentions=mentions, numbers=numbers, fits=np.zeros((len(mentions), 1)))
    share = np.random.default_rng(1).dirichlet(np.ones(len(scene)), size=len(mentions))
    nothing = np.zeros((len(mentions), len(scene)))
    walk = Walked(
        scene=scene,
        at_places=nothing.T,
        own=nothing,
        expected_at=expected_at(tokens, mentions),
        placed=share,
        elsewhere=share,
    )
    columns = Columns()
    add_directions(columns, said, walk, np.zeros(len(mentions)))
    return dict(zip(columns.names, columns.rows(len(mentions)).T, strict=True))


def test_the_mirror_image_has_the_same_columns() -> None:
    other = {"left": "right", "right": "left", "leftmost": "rightmost"}
    mirrored_text = " ".join(other.get(word, word) for word in TEXT.split())
    told, mirrored = columns_of(crooked_walk(), TEXT), columns_of(in_mirror(crooked_walk()), mirrored_text)
    assert told.keys() == mirrored.keys()
    for name, values in told.items():
        np.testing.assert_allclose(values, mirrored[name], atol=1e-6, err_msg=name)


def test_the_other_side_of_a_thing_has_the_opposite_way_by() -> None:
    right = columns_of(crooked_walk(), TEXT)
    left = columns_of(crooked_walk(), TEXT.replace("the right of", "the left of"))
    side = 1  # of the sides that are said, the one of the couch
    for name in ("beside_way_by_1", "beside_way_by_2", "beside_way_by_top"):
        assert right[name][side] > 0.2  # the couch stands to the left of the way
        assert left[name][side] < -0.2
    assert len({round(float(right[f"beside_way_by_{which}"][side]), 4) for which in ("1", "2", "top")}) == 3
