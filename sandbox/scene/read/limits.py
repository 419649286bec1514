"""How large a scene may be. Each limit can be raised by an option, none is silent."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sandbox.elements.arrays import PER_SAMPLE, row_bytes
from sandbox.elements.element import LISTS, NAMED
from sandbox.elements.quantities import QUANTITIES
from sandbox.errors import Problem
from sandbox.scene.bodies import MAX_CORNERS
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import is_pattern


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of a scene; the defaults suffice for any hand on a desktop machine."""

    file_bytes: int = 5_000_000
    """Size of a scene's file."""
    nesting: int = 32
    """Objects and lists inside one another."""
    problems: int = 100
    """Problems reported of one file; further ones are counted."""
    bodies: int = 2_000
    """Bodies of the mechanism, those of parts included."""
    elements: int = 20_000
    """Elements of all kinds."""
    values: int = 200_000
    """Numbers, texts, lists and objects of a scene, also after its expansion."""
    matches: int = 3_000_000
    """Names that the patterns of contact rules, loads and expectations are compared with."""
    corners: int = 40_000
    """Corners of polygons and polylines as written, 2000 for each cam and drawing."""
    steps: int = 2_000_000
    """Time steps of a run."""
    samples: int = 1_000_000
    """Samples of a run."""
    recorded_bytes: int = 4_000_000_000
    """Recorded numbers of a run without meters: before it an estimate, during it the size."""
    seconds: int = 3_600
    """Time that a run is estimated to take."""
    frames: int = 20_000
    """Frames of a film."""
    pixels: int = 16_000_000
    """Pixels of a picture."""
    runs: int = 1_000_000
    """Runs of a sweep."""


def over(limits: Limits, name: str, amount: float, path: str, what: str) -> Iterator[Problem]:
    """The problem of an amount above a limit; ``what`` contains ``{count}``."""
    def text(number: float) -> str:
        """With its thousands apart, or a power of ten when it is astronomical."""
        return f"{int(number):,}".replace(",", " ") if number < 1e15 else f"{number:.1e}"

    limit = getattr(limits, name)
    if amount > limit:
        yield Problem("limit-exceeded", what.format(count=text(amount)), path, allowed=(
            f"at most {text(limit)} (the limit '{name}', raised by --limit {name}=N)"))


def check_size(data: dict[str, Any], limits: Limits) -> list[Problem]:
    """Lists of a scene's data that are too long, and too many values, before models read them."""
    problems: list[Problem] = []
    for key in (*LISTS, "parts", "materials", "parameters", "tables"):
        if isinstance(value := data.get(key), (list, dict)):
            limit = "bodies" if key in ("bodies", "parts") else "elements"
            problems += over(limits, limit, len(value), f"$.{key}",
                             f"the scene has {{count}} {key}")
    values, corners = 0, 0
    waiting: list[Any] = [{**data, "templates": None}]  # only copies of templates count
    while waiting and values <= limits.values:
        entry = waiting.pop()
        if isinstance(entry, dict):
            kind = entry.get("type")
            if kind in ("cam", "drawing"):
                corners += MAX_CORNERS
            elif kind in ("polygon", "polyline", "curve"):
                holes = entry.get("holes")
                corners += sum(len(ring) for ring in (
                    entry.get("points"), *(holes if isinstance(holes, list) else ()))
                    if isinstance(ring, list))
        if isinstance(entry, (dict, list)):
            values += len(entry)
            waiting += entry.values() if isinstance(entry, dict) else entry
    return [*problems,
            *over(limits, "corners", corners, "$.bodies", "outlines have {count} corners"),
            *over(limits, "values", values, "$", "the scene has {count} values and more")]


def check_limits(mechanism: Mechanism, limits: Limits) -> list[Problem]:
    """Exceeded limits of a mechanism: elements, steps, samples, memory, pictures."""
    run, view = mechanism.run, mechanism.view
    samples = run.duration * run.sample_rate
    names = sum(len(getattr(mechanism, kind)) * len(QUANTITIES.get(named.one, {"": None}))
                for kind, named in NAMED.items())
    of_bodies = sum(is_pattern(text) for rule in mechanism.contacts for text in {*rule.between}) \
        + sum(len(load.bodies) for load in mechanism.loads)
    matches = of_bodies * len(mechanism.bodies) + names * sum(
        is_pattern(expect.quantity) for expect in mechanism.expect)
    size = (
        ("bodies", len(mechanism.bodies), "$.bodies", "the mechanism has {count} bodies"),
        ("elements", sum(len(getattr(mechanism, kind)) for kind in LISTS), "$",
         "the mechanism has {count} elements"),
        ("matches", matches, "$", "patterns of contact rules, loads and expectations have to be "
                                  "compared with {count} names"),
        ("pixels", view.size[0] * view.size[1], "$.view.size", "a picture has {count} pixels"))
    time = (
        ("steps", run.duration / run.step, "$.run.duration",
         f"a duration of {run.duration:g} s in steps of {run.step:g} s is {{count}} steps"),
        ("samples", samples, "$.run.sample_rate",
         f"{run.sample_rate:g} samples a second for {run.duration:g} s are {{count}} samples"),
        ("recorded_bytes", samples * row_bytes(mechanism, PER_SAMPLE), "$.run.sample_rate",
         "the recording would take {count} bytes"),
        ("frames", run.duration / view.speed * view.fps, "$.view", "the film has {count} frames"))
    first = [problem for row in time for problem in over(limits, *row)][:1]  # the cause of others
    return [problem for row in size for problem in over(limits, *row)] + first
