"""Types of arrays, and connected components of a graph."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]  # quantities, 8 bytes each
Matrix = Array  # the same, with two axes where a compiled function takes it
Stack = Array  # the same, with three axes
Integers = NDArray[np.int64]  # indices and counts
Flags = NDArray[np.bool_]  # booleans
Records = NDArray[Any]  # rows with named fields (a structured dtype)


def connected_components(links: Flags) -> list[Integers]:
    """Groups of connected nodes, ascending, of a symmetric adjacency matrix [n, n]."""
    # importing scipy.sparse.csgraph would delay each start by 0.4 s
    open_nodes = np.ones(len(links), dtype=bool)
    found = []
    for node in range(len(links)):
        if open_nodes[node]:
            group = frontier = np.arange(len(links)) == node
            while frontier.any():
                frontier = links[frontier].any(axis=0) & ~group
                group = group | frontier
            open_nodes &= ~group
            found.append(np.flatnonzero(group))
    return found
