"""Forces in a determinate truss by the method of joints, signed: a rod that pulls is positive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np


def bar_forces(nodes: Mapping[str, complex], rods: Sequence[tuple[str, str]],
               loads: Mapping[str, complex], pinned: str, rolled: str,
               ) -> tuple[list[float], complex, float]:
    """Forces in the rods, on the pinned node and, along y, on the rolled one [N].

    At every node the pulls of its rods, its load and its bearing vanish.
    """
    names = list(nodes)
    A = np.zeros((2 * len(names), len(rods) + 3))
    for k, (a, b) in enumerate(rods):
        line = (nodes[b] - nodes[a]) / abs(nodes[b] - nodes[a])
        for name, pull in ((a, line), (b, -line)):
            i = 2 * names.index(name)
            A[i:i + 2, k] += pull.real, pull.imag
    A[2 * names.index(pinned), -3] = A[2 * names.index(pinned) + 1, -2] = 1.0
    A[2 * names.index(rolled) + 1, -1] = 1.0
    load = np.array([[loads[name].real, loads[name].imag] for name in names]).ravel()
    found = np.linalg.solve(A, -load)
    return found[:-3].tolist(), complex(found[-3], found[-2]), float(found[-1])
