"""Where the two points are that a joint, a straight spring or a chamber of fluid acts between."""

from __future__ import annotations

from typing import Any

from sandbox.engine.kernel import kernel
from sandbox.numeric import Array


@kernel
def ends(element: Any, body: Array, turn: Array) -> tuple[float, float, float, float, float, float]:
    """Arms of the two points of an element, and the way from the first to the second.

    Args:
        element: a record with bodies ``a`` and ``b`` and the points ``ax``, ``ay``, ``bx``, ``by``.
        body: poses of the centres of mass, [nb, 6].
        turn: cosine and sine of their angles, [nb, 2].

    Returns:
        From its body's centre of mass to the point on ``a``, and to that on ``b``; from the one to
        the other; x and y of each in the world [m].
    """
    a, b = element["a"], element["b"]
    ca, sa, cb, sb = turn[a, 0], turn[a, 1], turn[b, 0], turn[b, 1]
    ax, ay = ca * element["ax"] - sa * element["ay"], sa * element["ax"] + ca * element["ay"]
    bx, by = cb * element["bx"] - sb * element["by"], sb * element["bx"] + cb * element["by"]
    return ax, ay, bx, by, body[b, 0] + bx - body[a, 0] - ax, body[b, 1] + by - body[a, 1] - ay
