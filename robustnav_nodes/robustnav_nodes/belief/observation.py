"""What one observation says about each candidate location: the factor d of Bayes' rule (thesis 3.2.1.3).

A factor is float64 [k], positive everywhere and summing to one; only its ratios matter.
"""

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.search_space.candidates import Candidates


def missed_factor(in_view: Bool, f1: float) -> Float64:
    """The factor d after a view (bool [k]) in which the detector did not fire.

    `f1` is the class's F1, within 0.5 .. 1 exclusive of 1 (see `usable_f1`). C3: 1 - F1 inside the view and
    F1 outside, so that what was looked at without success becomes less likely; the thesis' text has the two
    the other way round.
    """
    factor = np.where(in_view, 1.0 - f1, f1)
    return _summing_to_one(factor)


def detected_factor(
    candidates: Candidates, in_view: Bool, detected_m: Float64, sigma_m: float, floor: float
) -> Float64:
    """The factor d after the detector fired at places `detected_m` (float64 [m, 2], m > 0, map frame).

    Inside the view a normal density of `sigma_m` around the nearest detection, its peak scaled to one;
    `floor` (> 0) everywhere that this does not reach. Of several detections in one view each may be the
    target, so a location takes the largest, not the product.

    C2: the thesis has 0 outside the view. A factor of 0 is for ever: one false alarm would delete the truth.
    """
    dx = candidates.x_m[:, np.newaxis] - detected_m[np.newaxis, :, 0]
    dy = candidates.y_m[:, np.newaxis] - detected_m[np.newaxis, :, 1]
    nearest_squared = np.min(dx * dx + dy * dy, axis=1)
    normal = np.exp(-0.5 * nearest_squared / sigma_m**2)
    factor = np.where(in_view, np.maximum(normal, floor), floor)
    return _summing_to_one(factor)


def usable_f1(f1: float, f1_min: float, f1_max: float) -> float:
    """`f1` within limits where `missed_factor` makes sense (C4).

    Above f1_max one miss would rule a place out for ever. Below one half a miss would make a place more
    likely; a detector as bad as that says nothing when it is silent.
    """
    return min(max(f1, f1_min), f1_max)


def _summing_to_one(factor: Float64) -> Float64:
    return np.asarray(factor / factor.sum(), dtype=np.float64)
