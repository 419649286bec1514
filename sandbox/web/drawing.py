"""Data for drawings in a browser: display lists with all layers, the camera, sides of labels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sandbox.model.catalogue import Catalogue
from sandbox.model.meters import curves
from sandbox.numeric import Integers
from sandbox.picture.bounds import Rectangle, body_box, place_camera, whole_box, width_shown
from sandbox.picture.build import subject_of
from sandbox.picture.labels import place_labels
from sandbox.picture.listing import Listing, RunData, short
from sandbox.picture.subject import Subject
from sandbox.scene.layers import EVERY, LAYERS, shown
from sandbox.scene.settings import View
from sandbox.values.expressions import is_expression

WIDTH, POINT, TYPE = 800, 1.0, 13
"""Size that labels are placed for: width of a drawing, pixels per point, font size [pixels]."""
LEGEND = 2.2  # height of the legend, in font sizes
DIGITS = 5  # digits of numbers in lists and heads
OWN = ("force", "spring", "drive")
"""Colours of the script itself: under the pointer, loads without colours, the hand."""
MOVES = 1e-12  # poses that change by less are constant


def all_layers(view: View) -> View:
    """The view with every layer, since the reader switches them."""
    of = {name: EVERY for name in LAYERS if name != "coordinates"}
    return view.model_copy(update={"show": {**of, **{
        name: patterns for name, patterns in view.show.items() if patterns and name in of}}})


def listed(
    run: RunData, beside: Sequence[RunData] = (), *, live: bool = False,
) -> tuple[Subject, list[float]]:
    """The display list of a run with its layers, and sides of the labels of those shown at first.

    ``beside`` are runs that share its scales. For a ``live`` view only the layers shown at first
    are listed, since other lists follow.

    Returns:
        The list, and the box of the picture: x0, y0, x1, y1 [m].
    """
    view = run.mechanism.view
    width, height = view.size
    bodies = body_box(run, view)
    across = width_shown(bodies, width / height, view.width)
    size = (WIDTH, round(WIDTH * height / width))
    stage = Rectangle(0, 0, size[0], max(8, round(size[1] - LEGEND * TYPE)))
    guess = place_camera(bodies, stage, centre=view.centre, width=view.width)
    s = subject_of(run, view if live else all_layers(view), width=across,
                   point=POINT / guess.scale, beside=beside, fixed_columns=live)
    visible = shown(view.show, traced=bool(view.traces))
    items = s.out.items
    s.out.items = [item for item in items if item["l"] in visible]
    box = whole_box(s.out, run, bodies, view)
    camera = place_camera(box, stage, centre=view.centre, width=view.width)
    if not live:  # a live view chooses sides in the browser: it must begin quickly
        from sandbox.picture.typesetter import Typesetter  # loads pygame

        place_labels(s.out, camera, POINT, size, stage, Typesetter(TYPE), TYPE, speed=view.speed)
        for item in s.out.items:
            item["placed"] = 1
    s.out.items = items
    return s, [box.x0, box.y0, box.x1, box.y1]


def drawing(
    run: RunData, s: Subject, box: Sequence[float], *, live: bool = False,
) -> dict[str, Any]:
    """Data that a ``Stage`` needs to draw frames of a run, without the numbers that change."""
    mechanism, model, out = run.mechanism, run.model, s.out
    view, names = mechanism.view, [body.name for body in mechanism.bodies]
    visible = shown(view.show, traced=bool(view.traces))
    return {
        "name": mechanism.name, "title": mechanism.title or mechanism.name, "live": int(live),
        "bodies": [{"name": name, "fixed": bool(fixed), "centre": [short(v) for v in centre]}
                   for name, fixed, centre in zip(names, model.bodies.fixed,
                                                  run.arrays["body_centre"], strict=True)],
        "moving": moving(out).tolist(), "rest": [short(v) for v in out.pose[0].ravel()],
        "ramps": {"load": "tensions"}, "plain": "spring",
        "box": rounded(box),
        "view": {"centre": view.centre, "width": view.width, "follow": view.follow,
                 "aspect": view.size[0] / view.size[1], "speed": view.speed},
        "layers": [{"name": name, "words": layer.words, "about": layer.about,
                    "on": name in visible} for name, layer in LAYERS.items()],
    }


def page_list(out: Listing) -> dict[str, Any]:
    """The display list for the script, without the numbers that change."""
    own = {token: out.inks[token] for token in OWN if token in out.inks}
    head = out.head()
    return {"list": rounded({**head, "items": out.items,
                             "inks": {**head["inks"], **own}}),
            "tables": {name: rows.shape[1] for name, rows in out.tables.items()},
            "columns": len(out.columns), "frames": out.pose.shape[1]}


def moving(out: Listing) -> Integers:
    """Numbers of the frames that move."""
    return np.flatnonzero((np.ptp(np.nan_to_num(out.pose), axis=0) > MOVES).any(axis=1))


def rounded(data: Any) -> Any:
    """Plain data with short numbers and plain types."""
    if isinstance(data, dict):
        return {key: rounded(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [rounded(value) for value in data]
    if isinstance(data, float | np.floating):
        value = float(f"{float(data):.{DIGITS}g}") if math.isfinite(data) else 0.0
        return int(value) if value == int(value) and abs(value) < 1e9 else value
    return int(data) if isinstance(data, np.integer) else data


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
