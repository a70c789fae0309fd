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


def place_densities(candidates: Candidates, in_view: Bool, detected_m: Float64, sigma_m: float) -> Float64:
    """How well detections at `detected_m` (float64 [m, 2], map frame) fit each candidate: float64 [m, k].

    In view a normal density of `sigma_m` around the detection, its peak scaled to one; 0 outside the view.
    """
    seen = np.nonzero(in_view)[0]
    dx = candidates.x_m[np.newaxis, seen] - detected_m[:, 0, np.newaxis]
    dy = candidates.y_m[np.newaxis, seen] - detected_m[:, 1, np.newaxis]
    densities = np.zeros((len(detected_m), len(in_view)))
    densities[:, seen] = np.exp(-0.5 * (dx * dx + dy * dy) / sigma_m**2)
    return densities


def detected_factor(in_view: Bool, densities: Float64, floor: float) -> Float64:
    """The factor d after the detector fired, with `densities` (float64 [m, k], m > 0, see place_densities).

    `floor` (> 0) everywhere that these do not reach. Of several detections in one view each may be the
    target, so a location takes the largest, not the product.

    C2: the thesis has 0 outside the view. A factor of 0 is for ever: one false alarm would delete the truth.
    """
    return _summing_to_one(np.where(in_view, np.maximum(densities.max(axis=0), floor), floor))


def usable_f1(f1: float, f1_min: float, f1_max: float) -> float:
    """`f1` within limits where `missed_factor` makes sense (C4).

    Above f1_max one miss would rule a place out for ever. Below one half a miss would make a place more
    likely; a detector as bad as that says nothing when it is silent.
    """
    return min(max(f1, f1_min), f1_max)


def _summing_to_one(factor: Float64) -> Float64:
    return np.asarray(factor / factor.sum(), dtype=np.float64)
