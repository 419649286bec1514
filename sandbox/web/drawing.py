"""What a browser draws of a run: its display list with all layers, the camera, sides of labels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sandbox.kinds.layers import EVERY, LAYERS, shown
from sandbox.numeric import Array
from sandbox.picture.bounds import body_box, whole_box
from sandbox.picture.build import subject_of
from sandbox.picture.camera import Stage, place_camera, width_shown
from sandbox.picture.instant import Instant
from sandbox.picture.labels import place_labels
from sandbox.picture.listing import Listing, short
from sandbox.picture.run_data import RunData
from sandbox.picture.subject import Subject
from sandbox.picture.typesetter import Typesetter
from sandbox.scene.elements.settings import View

WIDTH, POINT, TYPE = 800, 1.0, 13
"""Size that labels are placed for: width of a drawing, pixels per point, font size [pixels]."""
LEGEND = 2.2
"""Height of the legend, in font sizes."""
DIGITS = 5
"""Digits of numbers in lists and heads."""
SLIDES = 1e-12
"""Poses that change by less are constant."""


def all_layers(view: View) -> View:
    """The view with every layer, since the reader switches them."""
    of = {name: EVERY for name in LAYERS if name != "coordinates"}
    return view.model_copy(update={"show": {**of, **{
        name: patterns for name, patterns in view.show.items() if patterns and name in of}}})


def listed(run: RunData, beside: Sequence[RunData] = (), *, live: bool = False) -> Subject:
    """The display list of a run with all layers, and the sides of labels of those shown at first.

    Args:
        run: the recording.
        beside: runs that share its scales.
        live: whether lists of other samples of the run follow.
    """
    view = run.mechanism.view
    width, height = view.size
    bodies = body_box(run, view)
    across = width_shown(bodies, width / height, view.width)
    size = (WIDTH, round(WIDTH * height / width))
    stage = Stage(0, 0, size[0], max(8, round(size[1] - LEGEND * TYPE)))
    guess = place_camera(bodies, stage, centre=view.centre, width=view.width)
    s = subject_of(run, all_layers(view), width=across, point=POINT / guess.scale, beside=beside,
                   fixed_columns=live)
    visible = shown(view.show, traced=bool(view.traces))
    items = s.out.items
    s.out.items = [item for item in items if item["l"] in visible]
    box = whole_box(s.out, run, bodies, view)
    camera = place_camera(box, stage, centre=view.centre, width=view.width)
    instant = Instant(s.out, camera, POINT, (-size[0], -size[1], 2 * size[0], 2 * size[1]))
    type_ = Typesetter(TYPE, 0)

    def half(words: str) -> tuple[float, float]:
        return type_.width(words) / 2 + 1, 0.6 * TYPE

    place_labels(instant, half, (0, 0, stage.width, stage.height), 1.0, speed=view.speed,
                 width=WIDTH)
    for item in s.out.items:
        item["placed"] = 1
    s.out.items = items
    names = [body.name for body in run.mechanism.bodies]
    for item in items:
        if item["k"] == "arrows" and item["l"] == "contacts":  # whose quantities it shows
            keys = np.unique(s.out.tables[item["t"]][:, 1]).astype(int).tolist()
            item["refs"] = {key: f"{names[key // len(names)]}/{names[key % len(names)]}"
                            for key in keys}
    s.box = [box.x0, box.y0, box.x1, box.y1]  # type: ignore[attr-defined]
    return s


def drawing(run: RunData, s: Subject, *, live: bool = False) -> dict[str, Any]:
    """All that a ``Stage`` needs to draw frames of a run, but for the numbers that change."""
    mechanism, model, out = run.mechanism, run.model, s.out
    view, names = mechanism.view, [body.name for body in mechanism.bodies]
    visible = shown(view.show, traced=bool(view.traces))
    return {
        "name": mechanism.name, "title": mechanism.title or mechanism.name, "live": int(live),
        "bodies": [{"name": name, "fixed": bool(fixed), "centre": [short(v) for v in centre]}
                   for name, fixed, centre in zip(names, model.bodies.fixed,
                                                  run.arrays["body_centre"], strict=True)],
        "moving": moving(out).tolist(), "rest": [short(v) for v in out.pose[0].ravel()],
        "tables": list(out.tables),
        "ramps": {"load": "tensions"}, "plain": "spring",
        "box": s.box,  # type: ignore[attr-defined]
        "view": {"centre": view.centre, "width": view.width, "follow": view.follow,
                 "aspect": view.size[0] / view.size[1], "speed": view.speed},
        "layers": [{"name": name, "words": layer.words, "about": layer.about,
                    "on": name in visible} for name, layer in LAYERS.items()],
    }


def moving(out: Listing) -> Array:
    """Numbers of the frames that move."""
    return np.flatnonzero((np.ptp(np.nan_to_num(out.pose), axis=0) > SLIDES).any(axis=1))


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
