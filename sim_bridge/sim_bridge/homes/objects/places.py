"""Kinds of furniture that go together, with how willingly an object of an everyday class stands there."""

from collections.abc import Mapping

Weights = Mapping[str, float]

TABLES: Weights = {
    "dining table": 3.0,
    "coffee table": 3.0,
    "desk": 2.5,
    "side table": 1.5,
    "console table": 1.5,
}
CHESTS: Weights = {
    "sideboard": 3.0,
    "dresser": 2.5,
    "nightstand": 2.0,
    "low shelf": 2.0,
    "tv stand": 0.7,
    "filing cabinet": 1.0,
}
SEATS: Weights = {
    "sofa": 3.0,
    "armchair": 2.0,
    "bed": 2.5,
    "single bed": 2.5,
    "chair": 0.7,
    "stool": 0.7,
    "office chair": 0.7,
}
WORKTOPS: Weights = {"kitchen counter": 4.0, "dining table": 2.5, "sink unit": 1.5, "stove": 0.5}
WASHING: Weights = {
    "washstand": 3.0,
    "bathtub": 1.0,
    "toilet": 1.0,
    "washing machine": 1.5,
    "dryer": 1.5,
}
FLOOR: Weights = {"mat": 4.0, "shoe bench": 2.0, "toy chest": 1.5}
