"""Options of pictures that override the scene's view."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

from pydantic import ValidationError

from sandbox.errors import OutputError
from sandbox.model.meters import problems_of
from sandbox.picture.palette import EM
from sandbox.samples.samples import Samples
from sandbox.scene.check.references import check_references
from sandbox.scene.layers import parse_layers
from sandbox.scene.settings import View
from sandbox.values.messages import explain
from sandbox.wording import WrongValueError, quoted

SIZES = ('(width, height) in pixels, each 64 to 8192, "2x" for twice the view\'s, or '
         '"85mm" or "85mm x 70mm" for a still on paper')
PRINT_PER_INCH = 300  # pixels
LETTERS = 7.0  # the smallest letters on paper [pt]
PRINT_TYPE = math.ceil(LETTERS / 72 * PRINT_PER_INCH / EM)  # the same, as a typesetter counts it
UNITS = {"mm": 1.0, "cm": 10.0, "in": 25.4}  # millimetres in each
MIN_SIDE, MAX_SIDE = 25.0, 650.0  # of a width or a height [mm]
_NUMBER, _UNIT = r"\s*([0-9]+\.?[0-9]*|\.[0-9]+)\s*", f"({'|'.join(UNITS)})"
_FORM = re.compile(f"{_NUMBER}(?:{_UNIT}?\\s*[x×]{_NUMBER})?{_UNIT}\\s*", re.IGNORECASE)


def view_of(view: View, given: Mapping[str, Any]) -> View:
    """A view with the options of :func:`render` that are not None; layers are added or removed."""
    changes = {key: value.tolist() if hasattr(value, "tolist") else list(value) if isinstance(
        value, tuple) else value for key, value in given.items()
               if value is not None and not (key == "size" and paper_of(value))}
    with suppress(ValueError):  # View refuses it as it is
        if "show" in changes:
            changes["show"] = {**view.show, **parse_layers(changes["show"])}
    with suppress(ValueError, OverflowError):
        if found := re.fullmatch(r"\s*([0-9.]+)\s*[xX×]\s*", str(changes.get("size"))):
            changes["size"] = tuple(round(float(found[1]) * v) for v in view.size)
    if "bodies" in changes or "follow" in changes:  # the scene's window is of another picture
        changes.setdefault("centre", None)
    if "bodies" in changes:
        changes.setdefault("width", None)
    for key in ("bodies", "meters"):
        if isinstance(changes.get(key), str):
            changes[key] = [changes[key]]
    data = {**view.model_dump(by_alias=True), **changes}
    try:
        made = View.model_validate(data)
    except ValidationError as error:
        problems = {}
        for problem in explain(error, data, View):
            key = problem.path.removeprefix("$.").partition("[")[0]
            allowed = SIZES if key == "size" else problem.allowed
            problems[key] = f"{key}={quoted(given.get(key))}: " + str(WrongValueError(
                problem.code, problem.message, allowed=allowed, hint=problem.hint))
        raise OutputError("\n".join(problems.values()), code="bad-picture") from None
    (wide, high), (w, h) = made.size, view.size
    if made.width is None or "width" in changes or wide * h <= w * high:
        return made
    return made.model_copy(update={"width": made.width * wide * h / (w * high)})  # all of it


def check_view(run: Samples, view: View) -> None:
    """Check that the bodies and quantities of a view exist; else raise an OutputError."""
    mechanism = run.mechanism.model_copy(update={"view": view})
    problems = [str(replace(problem, path=problem.path.removeprefix("$.view."))) for problem in (
        *check_references(mechanism), *problems_of(run.catalogue, view))
        if problem.path.startswith("$.view.")]
    if problems:
        raise OutputError("\n".join(problems), code="bad-picture")


def check_run(run: Samples) -> None:
    """Check that there is a recording with samples; else raise an OutputError."""
    if not isinstance(run, Samples):
        raise OutputError(f"{quoted(run)} is no recording; pass what sandbox.simulate or "
                          "sandbox.Recording.load gives", code="bad-picture")
    if not len(run.time):
        raise OutputError("the recording has no samples: there is nothing to draw", code="bad-time")


class PrintSize(NamedTuple):
    """Size of a printed still [mm]; the height is None if it is free."""

    width: float
    height: float | None = None

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height [pixels]; a free height is 0."""
        wide, high = (round(side / UNITS["in"] * PRINT_PER_INCH)
                      for side in (self.width, self.height or 0.0))
        return wide, high


def paper_of(size: Any) -> PrintSize | None:
    """``85mm``, ``85mm x 70mm`` or ``3.35in`` as a size on paper [mm]; None for another size."""
    found = _FORM.fullmatch(size) if isinstance(size, str) else None
    if found is None:
        return None
    first, own, second, unit = found.groups()
    scale = UNITS[unit.lower()]
    paper = PrintSize(float(first) * (UNITS[own.lower()] if own else scale),
                      None if second is None else float(second) * scale)
    if any(not MIN_SIDE <= side <= MAX_SIDE for side in (paper.width, paper.height or MIN_SIDE)):
        raise OutputError(f"{quoted(size)}: a picture on paper is {MIN_SIDE:g} to {MAX_SIDE:g} mm "
                          "wide and high", code="bad-picture")
    return paper
