"""The meters of a scene's view, as a browser opens them: which curves, their title and range."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sandbox.model.catalogue import Catalogue
from sandbox.model.meters import curves, is_expression
from sandbox.scene.settings import View

if TYPE_CHECKING:
    from sandbox.web.frames import LiveFrames

MOST_METERS = 12
"""Meters of a live view that run at once."""
FIRST_METERS = 4


def meters_of(view: View, known: Catalogue) -> list[dict[str, Any]]:
    """Each with the ``names`` of its curves, of which there is one at least.

    ``range`` [lowest, highest] in SI, or none; ``number`` is 1 of one without a curve.
    """
    found = [{"names": curves(meter, known), "title": meter.title, "range": meter.range,
              "number": int(meter.style == "number")} for meter in view.meters]
    return [one for one in found if one["names"]]


def expressions_of(view: View) -> dict[str, str]:
    """The expressions among the curves, each with its unit."""
    return {word: meter.unit for meter in view.meters for word in meter.of if is_expression(word)}


def first_meters(frames: LiveFrames, usual: Mapping[str, list[str]]) -> list[str]:
    """The quantities that a live view plots at first.

    These are the meters of the scene's view, as many as may run at once; else the meters that the
    scene defines, else the first of the ``usual`` quantities.
    """
    shown: list[str] = []
    for meter in frames.meters:
        both = list(dict.fromkeys([*shown, *meter["names"]]))
        shown = both if len(both) <= MOST_METERS else shown
    if shown:
        return shown
    found = ([name for name in names if name in frames.units] for names in usual.values())
    return next((names[:FIRST_METERS] for names in found if names), [])
