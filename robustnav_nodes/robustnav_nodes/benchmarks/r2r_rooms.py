"""Which room a viewpoint is in, told by the names of the objects near it, never by labels of its own scan."""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

FOLDS = 5
_AT_LEAST = 3  # viewpoints that list a word; rarer ones say nothing


def out_of_fold_evidence(
    viewpoints: Mapping[str, tuple[str, Sequence[str]]], labels: Mapping[str, str]
) -> dict[str, list[float]]:
    """A probability for each of ROOM_TYPES for each viewpoint; `viewpoints`: scan and object names of each.

    Multinomial logistic regression on the words of the names; a scan's viewpoints are judged by a model that
    has not seen the scan. Raises BadParameterError where scikit-learn is not installed, BadFileError where
    too few scans are labelled.
    """
    try:
        from sklearn.feature_extraction import DictVectorizer
        from sklearn.linear_model import LogisticRegression
        from sklearn.model_selection import GroupKFold
    except ImportError as error:
        raise BadParameterError(
            "room evidence needs scikit-learn; install it with pip install 'robustnav[learn]'"
        ) from error

    names = sorted(viewpoints)
    groups = np.array([viewpoints[name][0] for name in names])
    words = [_words(viewpoints[name][1]) for name in names]
    often = Counter(word for said in words for word in said)
    kept = DictVectorizer(sparse=True).fit_transform(
        [{word: 1.0 for word in said if often[word] >= _AT_LEAST} for said in words]
    )
    known = np.array([labels.get(name, "") for name in names])
    scans = sorted({group for group, label in zip(groups, known, strict=True) if label})
    if len(scans) < 2:
        raise BadFileError(f"{len(scans)} scans have room labels; at least 2 are needed to tell rooms")
    found = np.zeros((len(names), len(ROOM_TYPES)))
    for train, test in GroupKFold(min(FOLDS, len(set(groups)))).split(kept, groups=groups):
        labelled = train[known[train] != ""]
        if len(set(known[labelled])) < 2:  # nothing to tell apart
            found[test] = 1.0 / len(ROOM_TYPES)
            continue
        model = LogisticRegression(max_iter=500).fit(kept[labelled], known[labelled])
        columns = [ROOM_TYPES.index(room) for room in model.classes_]
        found[np.ix_(test, columns)] = model.predict_proba(kept[test])
    return {name: [round(float(p), 3) for p in row] for name, row in zip(names, found, strict=True)}


def _words(objects: Sequence[str]) -> set[str]:
    """Whole names and their words, and that there was anything at all."""
    words = {f"name {name}" for name in objects} | {word for name in objects for word in name.split()}
    return words | {"anything"} if objects else {"nothing"}
