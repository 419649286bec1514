"""How large a scene may be. Each limit can be raised by an option, none is silent."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

from sandbox.elements.arrays import PER_SAMPLE, row_bytes
from sandbox.elements.element import LISTS, NAMED
from sandbox.elements.quantities import QUANTITIES
from sandbox.errors import Problem
from sandbox.scene.bodies import MOST_CORNERS, SHAPES
from sandbox.scene.document import Scene
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
    """Names that the patterns of contact rules, loads and expectations are held against."""
    corners: int = 40_000
    """Corners of polygons and polylines as written, 2000 for each cam and drawing."""
    steps: int = 2_000_000
    """Time steps of a run."""
    samples: int = 1_000_000
    """Samples of a run."""
    recorded_bytes: int = 4_000_000_000
    """Recorded numbers of a run; of contacts as many as are to be expected, and then those there
    are; meters left out."""
    seconds: int = 3_600
    """Time that a run is estimated to take."""
    frames: int = 20_000
    """Frames of a film."""
    pixels: int = 16_000_000
    """Pixels of a picture."""
    runs: int = 1_000_000
    """Runs of a sweep."""

    def raised(self, **changes: int) -> Limits:
        """The same limits with some of them changed.

        Raises:
            ValueError: an unknown limit.
        """
        known = {field.name: getattr(self, field.name) for field in fields(self)}
        if unknown := sorted(set(changes) - set(known)):
            raise ValueError(f"unknown limit {unknown[0]!r} (known: {', '.join(known)})")
        return Limits(**{**known, **changes})


def _matches(mechanism: Mechanism) -> int:
    """How many names patterns are held against: of bodies, or of all quantities."""
    recorded = sum(len(getattr(mechanism, kind)) * len(QUANTITIES.get(named.one, {"": None}))
                   for kind, named in NAMED.items())
    rules = sum(is_pattern(text) for rule in mechanism.contacts for text in {*rule.between})
    patterns = sum(is_pattern(expect.quantity) for expect in mechanism.expect)
    borne = sum(len(load.bodies) for load in mechanism.loads)
    return (rules + borne) * len(mechanism.bodies) + patterns * recorded


def over(limits: Limits, name: str, amount: float, path: str, what: str) -> Iterator[Problem]:
    """The problem of an amount above a limit; ``what`` contains ``{count}``."""
    most = getattr(limits, name)
    if amount > most:
        yield Problem("limit-exceeded", what.format(count=_count(amount)), path, allowed=(
            f"at most {_count(most)} (the limit '{name}', raised by --limit {name}=N)"))


def _count(number: float) -> str:
    """A whole number with its thousands apart, or a power of ten when it is astronomical."""
    return f"{int(number):,}".replace(",", " ") if number < 1e15 else f"{number:.1e}"


def check_lists(data: Any, limits: Limits) -> list[Problem]:
    """Lists that are too long as they are written, found before the models read them."""
    problems: list[Problem] = []
    for key, value in data.items() if isinstance(data, dict) else ():
        if isinstance(value, (list, dict)) and key in (
                *LISTS, "parts", "materials", "parameters", "tables"):
            problems += over(limits, _limit_of(key), len(value), f"$.{key}",
                             f"the scene has {{count}} {key}")
    if problems:
        return problems
    bodies = elements = corners = 0
    for holder in _holders(data):
        for key in (*LISTS, "parts") if holder is not data else ():
            count = len(_list(holder, key))
            elements += count
            bodies += count if _limit_of(key) == "bodies" else 0
        corners += sum(_corners(shape) for body in _list(holder, "bodies") for key in SHAPES
                       for shape in _list(body, key) if isinstance(shape, dict))
    return [*over(limits, "bodies", bodies, "$.parts",
                  "with those of its assemblies the scene has {count} bodies and parts"),
            *over(limits, "elements", elements, "$.parts",
                  "with those of its assemblies the scene has {count} elements"),
            *over(limits, "corners", corners, "$.bodies", "outlines have {count} corners")]


def _holders(data: Any) -> Iterator[Any]:
    """A scene as it is written, its assemblies, and those in them."""
    waiting = [data]
    while waiting:
        holder = waiting.pop()
        yield holder
        waiting += [part for part in _list(holder, "parts")
                    if isinstance(part, dict) and part.get("type") == "assembly"]


def _list(holder: Any, key: str) -> list[Any]:
    """A list of an object, empty if there is none."""
    value = holder.get(key) if isinstance(holder, dict) else None
    return value if isinstance(value, list) else []


def _corners(shape: dict[Any, Any]) -> int:
    if shape.get("type") in ("cam", "drawing"):
        return MOST_CORNERS
    rings = [_list(shape, "points"), *_list(shape, "holes")]
    return sum(len(ring) for ring in rings if isinstance(ring, list))


def _limit_of(key: str) -> str:
    return "bodies" if key in ("bodies", "parts") else "elements"


def check_values(data: Any, limits: Limits) -> list[Problem]:
    """Whether a scene has more values than can be read in a moment, each of which may be wrong."""
    count, waiting = 0, [data]
    while waiting and count <= limits.values:
        entry = waiting.pop()
        if isinstance(entry, (dict, list)):
            count += len(entry)
            waiting += entry.values() if isinstance(entry, dict) else entry
    return list(over(limits, "values", count, "$", "the scene has {count} values and more"))


def check_parts(scene: Scene, limits: Limits) -> list[Problem]:
    """Whether parts have too many bodies, counted before any of them is made."""
    count = sum(part.body_count for part in scene.parts)
    return list(over(limits, "bodies", count, "$.parts", "the parts have {count} bodies and more"))


def check_limits(mechanism: Mechanism, limits: Limits) -> list[Problem]:
    """Exceeded limits of a mechanism: elements, steps, samples, memory, pictures."""
    run, view = mechanism.run, mechanism.view
    samples = run.duration * run.sample_rate
    problems = [
        *over(limits, "bodies", len(mechanism.bodies), "$.bodies",
              "the mechanism has {count} bodies"),
        *over(limits, "elements", sum(len(getattr(mechanism, kind)) for kind in LISTS), "$",
              "the mechanism has {count} elements"),
        *over(limits, "matches", _matches(mechanism), "$", "patterns of contact rules, loads and "
              "expectations have to be held against {count} names"),
        *over(limits, "pixels", view.size[0] * view.size[1], "$.view.size",
              "a picture has {count} pixels")]
    time = [
        *over(limits, "steps", run.duration / run.step, "$.run.duration",
              f"a duration of {run.duration:g} s in steps of {run.step:g} s is {{count}} steps"),
        *over(limits, "samples", samples, "$.run.sample_rate",
              f"{run.sample_rate:g} samples a second for {run.duration:g} s are {{count}} samples"),
        *over(limits, "recorded_bytes", samples * row_bytes(mechanism, PER_SAMPLE),
              "$.run.sample_rate", "the recording would take {count} bytes"),
        *over(limits, "frames", run.duration / view.speed * view.fps, "$.view",
              "the film has {count} frames")]
    return problems + time[:1]  # the others follow from the same numbers
