"""L D L^T of the bilateral rows and hubs in a fixed order (:mod:`sandbox.engine.plan`).

``values`` holds the columns of L below the diagonal one after the other, then the diagonal: the
matrix before :func:`factor`, L and 1 / D after it.
"""

from __future__ import annotations

from sandbox.engine.kernel import kernel
from sandbox.numeric import Array, Integers


@kernel
def assemble(pairs: Integers, direct: Integers, J: Array, WJ: Array, values: Array) -> None:
    """Add up the matrix, compliances and masses of hubs left out."""
    for i in range(len(values)):
        values[i] = 0.0
    for k in range(len(pairs)):
        a, b = pairs[k, 1], pairs[k, 2]
        values[pairs[k, 0]] += J[a, 0] * WJ[b, 0] + J[a, 1] * WJ[b, 1] + J[a, 2] * WJ[b, 2]
    for k in range(len(direct)):
        values[direct[k, 0]] += J[direct[k, 1], direct[k, 2]]


@kernel
def factor(
    starts: Integers, below: Integers, updates: Integers, values: Array, column: Array,
) -> None:
    """Turn ``values`` into the factor; ``column`` [m] is scratch."""
    t, n = 0, len(starts) - 1
    diagonal = starts[n]
    for j in range(n):
        first, last = starts[j], starts[j + 1]
        inverse = 1.0 / values[diagonal + j]
        values[diagonal + j] = inverse
        for p in range(first, last):
            x = values[p]
            scaled = x * inverse
            column[p - first] = x
            values[p] = scaled
            values[diagonal + below[p]] -= scaled * x
            for q in range(p - first):
                values[updates[t + q]] -= scaled * column[q]
            t += p - first


@kernel
def forward(starts: Integers, below: Integers, values: Array, y: Array) -> None:
    """L^-1 y in place."""
    for j in range(len(starts) - 1):
        x = y[j]
        if x != 0.0:
            for p in range(starts[j], starts[j + 1]):
                y[below[p]] -= values[p] * x


@kernel
def backward(starts: Integers, below: Integers, values: Array, y: Array) -> None:
    """L^-T D^-1 y in place."""
    n = len(starts) - 1
    diagonal = starts[n]
    for j in range(n - 1, -1, -1):
        x = y[j] * values[diagonal + j]
        for p in range(starts[j], starts[j + 1]):
            x -= values[p] * y[below[p]]
        y[j] = x
