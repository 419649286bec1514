"""The meters of a scene's view, as a browser opens them: which curves, their title and range."""

from __future__ import annotations

from typing import Any

from sandbox.model.catalogue import Catalogue
from sandbox.model.shown_meters import curves, is_expression
from sandbox.scene.elements.settings import View


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
