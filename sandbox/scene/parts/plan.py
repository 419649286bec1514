"""The plan of a differential: which leaves share a rocker or wheel, and where everything lies.

``n`` leaves are halved again and again, so any number will do. The pivot of a
rocker divides the line between its two strings so that T1 a = T2 b, from which
T1 = F b / (a + b); the radii of a stepped wheel do the same. Pivots therefore
lie at the mean of their strings' places, weighted with their shares of the
pull, and every leaf gets its share F s_i / sum(s) while all strings are
parallel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Node:
    """A leaf, or a rocker (wheel) with the two strings that it pulls.

    ``across`` and ``along`` [m] say where it lies across and along the pull;
    ``share`` is its part of the whole pull; ``number`` counts the leaves from
    0 as given, and the rockers from 1, lowest level first.
    """

    across: float
    along: float
    share: float
    number: int
    height: int = 0
    below: tuple[Node, ...] = ()

    @property
    def arm(self) -> float:
        """The longer distance from its pivot to one of its strings [m]; 0 for a leaf."""
        return max((abs(node.across - self.across) for node in self.below), default=0.0)


def plan_tree(
    places: Sequence[tuple[float, float]], shares: Sequence[float], *,
    gap: float, level: float, wheels: bool,
) -> Node:
    """The root over leaves at ``places`` (along, across) [m] with ``shares`` of the pull.

    The first level lies ``gap`` behind the rearmost leaf and each next one
    ``level`` behind the one before; wheels keep these distances between their rims.
    """
    total = sum(shares)
    leaves = [
        Node(across=across, along=along, share=share / total, number=i)
        for i, ((along, across), share) in enumerate(zip(places, shares, strict=True))
    ]
    leaves.sort(key=lambda node: node.across, reverse=places[0][1] > places[-1][1])
    root = _halved(leaves)
    rows = nodes_of(root)
    numbers = {id(node): i + 1 for i, node in enumerate(rows)}
    along = _levels(rows, max(s for s, _ in places), gap, level, wheels=wheels)

    def placed(node: Node) -> Node:
        if not node.below:
            return node
        return replace(node, along=along[node.height], number=numbers[id(node)],
                       below=tuple(placed(child) for child in node.below))

    return placed(root)


def _halved(nodes: list[Node]) -> Node:
    if len(nodes) == 1:
        return nodes[0]
    middle = (len(nodes) + 1) // 2
    below = (_halved(nodes[:middle]), _halved(nodes[middle:]))
    share = sum(node.share for node in below)
    return Node(
        across=sum(node.across * node.share for node in below) / share, along=0.0, share=share,
        number=0, height=1 + max(node.height for node in below), below=below,
    )


def _levels(
    rows: list[Node], rearmost: float, gap: float, level: float, *, wheels: bool
) -> dict[int, float]:
    """Where each level lies along the pull [m], by height."""
    radius: dict[int, float] = {0: 0.0}
    for node in rows:
        radius[node.height] = max(radius.get(node.height, 0.0), node.arm if wheels else 0.0)
    along = {0: rearmost}
    for height in range(1, max(radius) + 1):
        distance = gap if height == 1 else level
        along[height] = along[height - 1] + radius[height - 1] + distance + radius[height]
    return along


def nodes_of(root: Node) -> list[Node]:
    """Every rocker or wheel of the tree, lowest level first, in the order of the leaves."""
    return sorted(_in_order(root), key=lambda node: node.height)


def _in_order(node: Node) -> list[Node]:
    below = [found for child in node.below for found in _in_order(child)]
    return [*below, node] if node.below else below
