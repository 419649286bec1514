"""Arrows of runs that stand beside each other, to one scale, so that they can be compared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

ARROWS = ("vectors", "loads", "pressure")
"""Kinds of part that have a scale of their own; contact forces go by that of the picture."""
ALIKE = 0.5
"""What a run needs of a picture, as a share of what all need, for it to be fitted to that."""
TOPS = ("reference", "most", "longest")
"""Of a scale: sizes [its unit] that are typical, largest in words, and where arrows are cut."""


def put_to_one_scale(heads: Sequence[Mapping[str, Any]]) -> None:
    """Give arrows of one sort the same scale in all drawings: that of the run with the largest.

    Args:
        heads: drawings of runs as :func:`sandbox.show.header.drawing` makes them; changed in place.
    """
    sorts: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    for head in heads:
        for sort, scale in _scales(head):
            sorts.setdefault(sort, []).append(scale)
    for scales in sorts.values():
        shown = [scale for scale in scales if scale["metres"] > 0]
        if not shown:
            continue
        metres = min(scale["metres"] for scale in shown)
        tops = {key: max(scale[key] for scale in shown) for key in TOPS if key in shown[0]}
        for scale in shown:
            scale |= {"metres": metres, **tops}
    _drives(heads)
    _boxes(heads)


def _boxes(heads: Sequence[Mapping[str, Any]]) -> None:
    """Fit pictures to what all runs need, where that is not much more than what each does."""
    x0, y0, x1, y1 = zip(*(head["box"] for head in heads), strict=True)
    box = [min(x0), min(y0), max(x1), max(y1)]
    if all(ALIKE * _size(box) <= _size(head["box"]) for head in heads):
        for head in heads:
            head["box"][:] = box


def _size(box: Sequence[float]) -> float:
    """The longer side of x0, y0, x1, y1 [m]."""
    return max(box[2] - box[0], box[3] - box[1])


def _scales(head: Mapping[str, Any]) -> Iterator[tuple[tuple[str, str, str], dict[str, Any]]]:
    """What is shown to which scale."""
    yield ("contacts", "", ""), head["scale"]
    for part in head["parts"]:
        if part["k"] in ARROWS:
            yield (part["k"], part["l"], part.get("unit", "")), part


def _drives(heads: Sequence[Mapping[str, Any]]) -> None:
    """Arrows that are ``long`` at the largest value of their drive: at that of all runs.

    By the scale of contact forces goes only what does so in every run.
    """
    same: dict[str, list[dict[str, Any]]] = {}
    for head in heads:
        for part in head["parts"]:
            if part["k"] == "drive":
                same.setdefault(part["n"], []).append(part)
    for parts in same.values():
        tops = {key: max(part[key] for part in parts) for key in ("most", "usual")}
        long, scaled = min(part["long"] for part in parts), all(part["scaled"] for part in parts)
        for part in parts:
            part |= {**tops, "long": long, "scaled": scaled}
