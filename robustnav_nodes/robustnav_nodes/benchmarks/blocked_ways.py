"""Ways that are open on the map and blocked in the world: a chair, a closed door, a person who stays."""

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from robustnav_nodes.search_space.pose_graph import NOWHERE, PoseGraph


def with_blocked_ways(graph: PoseGraph, share: float, rng: np.random.Generator) -> PoseGraph:
    """`graph` without about this `share` (0..1) of its ways between places, drawn by chance.

    Each is blocked in both directions and for every heading. A way whose loss would cut poses off from
    others that could reach each other before stays open, so there may be fewer.
    """
    ways = _ways_between_places(graph)
    wanted, parts = round(share * len(ways)), _parts(graph)
    for number in rng.permutation(len(ways)):
        if wanted == 0:
            break
        fewer = graph.without_way(*ways[number])
        if _parts(fewer) == parts:
            graph, wanted = fewer, wanted - 1
    return graph


def _ways_between_places(graph: PoseGraph) -> list[tuple[int, int]]:
    """A pair of poses for each pair of places that a way leads between."""
    _, place = np.unique(np.stack([graph.x_m, graph.y_m], axis=1), axis=0, return_inverse=True)
    place = place.reshape(-1)
    begins, action = np.nonzero(graph.successors != NOWHERE)
    ends = graph.successors[begins, action]
    moves = place[begins] < place[ends]
    begins, ends = begins[moves], ends[moves]
    _, first = np.unique(np.stack([place[begins], place[ends]], axis=1), axis=0, return_index=True)
    return [(int(begins[at]), int(ends[at])) for at in first]


def _parts(graph: PoseGraph) -> int:
    """How many sets of poses there are that can all reach each other."""
    begins, action = np.nonzero(graph.successors != NOWHERE)
    ends = graph.successors[begins, action]
    links = sparse.csr_matrix((np.ones(len(ends)), (begins, ends)), shape=(len(graph), len(graph)))
    return int(csgraph.connected_components(links, directed=True, connection="strong")[0])
