"""What may be asked of a picture besides what its scene says: held to what a scene may say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from sandbox.draw.film.canvas import Filmed
from sandbox.errors import OutputError
from sandbox.scene.elements.settings import View
from sandbox.scene.read.messages import explain
from sandbox.wording import quoted

OPTIONS = {
    "size": "(width, height) in pixels, each 64 to 8192",
    "fps": "20, 25 or 50 frames per second",
    "speed": "seconds of motion per second of film, greater than 0",
    "centre": "(x, y) of the world in metres",
    "width": "metres of the world shown, greater than 0",
}
"""What each is, as a message says it."""


def view_of(view: View, given: Mapping[str, Any]) -> View:
    """A view with some of :data:`OPTIONS` changed; those that are None are left as they are.

    Raises:
        OutputError: values that no view can have, one a line.
    """
    changes = {key: _plain(value) for key, value in given.items() if value is not None}
    if not changes:
        return view
    data = {**view.model_dump(by_alias=True), **changes}
    try:
        return View.model_validate(data)
    except ValidationError as error:
        told = {}
        for problem in explain(error, data, View):
            key = problem.path.removeprefix("$.").partition("[")[0]
            told[key] = (f"{key}={quoted(given.get(key))}: {problem.message}; "
                         f"pass {OPTIONS.get(key, 'what a view may have')}")
        raise OutputError("\n".join(told.values())) from None


def _plain(value: Any) -> Any:
    """NumPy's numbers and arrays as Python's."""
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return value.tolist() if hasattr(value, "tolist") else value


def check_run(run: Filmed) -> None:
    """That there is something to draw.

    Raises:
        OutputError: what is no recording, or one without samples.
    """
    if not (hasattr(run, "mechanism") and hasattr(run, "arrays")):
        raise OutputError(f"{quoted(run)} is no recording; pass what sandbox.simulate or "
                          "sandbox.Recording.load gives")
    if not len(run.time):
        raise OutputError("the recording has no samples: there is nothing to draw")
