"""How large a scene may be. Each limit can be raised by an option, none is silent."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

from sandbox.errors import Problem
from sandbox.kinds.arrays import sample_bytes
from sandbox.kinds.elements import LISTS
from sandbox.scene.mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a scene may ask for; the defaults leave room for any hand on a desktop machine."""

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
    steps: int = 2_000_000
    """Time steps of a run."""
    samples: int = 1_000_000
    """Samples of a run."""
    recorded_bytes: int = 4_000_000_000
    """Recorded numbers of a run, contacts and meters left out."""
    frames: int = 20_000
    """Frames of a film."""
    pixels: int = 16_000_000
    """Pixels of a picture."""

    def raised(self, **changes: int) -> Limits:
        """The same limits with some of them changed.

        Raises:
            ValueError: an unknown limit.
        """
        known = {field.name: getattr(self, field.name) for field in fields(self)}
        if unknown := sorted(set(changes) - set(known)):
            raise ValueError(f"unknown limit {unknown[0]!r} (known: {', '.join(known)})")
        return Limits(**{**known, **changes})


def _over(limits: Limits, name: str, asked: float, path: str, what: str) -> Iterator[Problem]:
    most = getattr(limits, name)
    if asked > most:
        option = name.replace("_", "-")
        yield Problem(what.format(count=_count(asked)), path, allowed=(
            f"at most {_count(most)} (the limit '{name}', raised by --max-{option})"))


def _count(number: float) -> str:
    """A whole number with its thousands apart, or a power of ten when it is astronomical."""
    return f"{int(number):,}".replace(",", " ") if number < 1e15 else f"{number:.1e}"


def check_lists(data: Any, limits: Limits) -> list[Problem]:
    """Lists that are too long as they are written, found before the models read them."""
    problems: list[Problem] = []
    for key, value in data.items() if isinstance(data, dict) else ():
        if isinstance(value, (list, dict)) and key in (*LISTS, "parts", "materials", "parameters"):
            name = "bodies" if key in ("bodies", "parts") else "elements"
            problems += _over(
                limits, name, len(value), f"$.{key}", f"the scene has {{count}} {key}")
    return problems


def check_limits(mechanism: Mechanism, limits: Limits) -> list[Problem]:
    """What a mechanism asks for beyond the limits: elements, steps, samples, memory, pictures."""
    run, view = mechanism.run, mechanism.view
    samples = run.duration * run.sample_rate
    machine: list[tuple[str, float, str, str]] = [
        ("bodies", len(mechanism.bodies), "$.bodies", "the mechanism has {count} bodies"),
        ("elements", sum(len(getattr(mechanism, kind)) for kind in LISTS), "$",
         "the mechanism has {count} elements"),
        ("pixels", view.size[0] * view.size[1], "$.view.size", "a picture has {count} pixels"),
    ]
    time: list[tuple[str, float, str, str]] = [
        ("steps", run.duration / run.step, "$.run.duration",
         f"a duration of {run.duration:g} s in steps of {run.step:g} s is {{count}} steps"),
        ("samples", samples, "$.run.sample_rate",
         f"{run.sample_rate:g} samples a second for {run.duration:g} s are {{count}} samples"),
        ("recorded_bytes", samples * sample_bytes(mechanism), "$.run.sample_rate",
         "the recording would take {count} bytes"),
        ("frames", run.duration / view.speed * view.fps, "$.view", "the film has {count} frames"),
    ]
    problems = [problem for check in machine for problem in _over(limits, *check)]
    for check in time:  # the first says enough: the others follow from the same numbers
        if too_long := list(_over(limits, *check)):
            return problems + too_long
    return problems
