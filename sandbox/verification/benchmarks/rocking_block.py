"""Housner's rocking block: a corner as hinge, and a blow without rebound at the other one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

G, APART = 9.81, 2.0


@dataclass(frozen=True)
class Block:
    """A block let go at rest on one corner, and what it does next."""

    width: float
    height: float
    tilt: float
    """At t = 0, as a share of the angle at which it would stand on its corner."""
    flat: float
    """When it lies flat for the first time [s]."""
    rate: float
    """Just before that [rad/s]."""
    peak: float
    """The largest tilt after that, as such a share."""
    again: float
    """When it lies flat for the second time [s]."""

    @property
    def slender(self) -> float:
        """The angle at which it would stand on its corner [rad]."""
        return float(np.arctan(self.width / self.height))

    @property
    def turning(self) -> float:
        """p² = 3 g / (4 R) with half the diagonal R [1/s²]."""
        return float(1.5 * G / np.hypot(self.width, self.height))

    @property
    def kept(self) -> float:
        """Of the rate at a blow, moments about the corner that hits."""
        return float(1 - 1.5 * np.sin(self.slender)**2)


BLOCKS = (
    Block(0.2, 0.6, 0.2, 0.144569221, 0.92460219, 0.139956507, 0.379602951),
    Block(0.2, 0.6, 0.5, 0.273858975, 1.33680871, 0.323871229, 0.666850965),
    Block(0.2, 0.6, 0.8, 0.475821995, 1.51380451, 0.447908568, 0.975290934),
    Block(0.1, 0.4, 0.5, 0.220835511, 1.26347863, 0.386714467, 0.580246330),
)


def scene(step: float) -> Json:
    """All blocks on one floor, each tilted clockwise on its right corner."""
    bodies: list[Json] = [{"name": "floor", "motion": "fixed", "material": "rough",
                           "shapes": [{"type": "box", "size": [10.0, 0.2], "at": [3.0, -0.1]}]}]
    for i, block in enumerate(BLOCKS):
        half, left = np.hypot(block.width, block.height) / 2, block.slender * (1 - block.tilt)
        bodies.append({
            "name": f"block{i + 1}", "mass": 1.0, "angle": -block.slender * block.tilt,
            "at": [APART * i - half * np.sin(left), half * np.cos(left)], "material": "rough",
            "shapes": [{"type": "box", "size": [block.width, block.height]}]})
    return spelled(1.0, step, gravity=[0.0, -G], bodies=bodies,
                   materials={"rough": {"friction": 1.5, "restitution": 0.0}})


def _course(run: Recording, i: int) -> tuple[np.ndarray, int, int, int]:
    """Its tilt at the samples, and those before it is flat, of its peak, before it is again."""
    tilt = -run[f"block{i + 1}.angle"]
    first = int(np.argmax(tilt <= 0)) - 1
    peak = first + int(np.argmin(tilt[first:int(np.argmax(run.time > BLOCKS[i].again + 0.02))]))
    return tilt, first, peak, peak + int(np.argmax(tilt[peak:] >= 0)) - 1


def _flat(i: int, second: bool) -> Callable[[Recording], float]:
    def found(run: Recording) -> float:
        tilt, first, _, again = _course(run, i)
        k = again if second else first
        share = tilt[k] / (tilt[k] - tilt[k + 1])
        return float(run.time[k] + share * (run.time[k + 1] - run.time[k]))

    return found


def _rate(i: int) -> Callable[[Recording], float]:
    return lambda run: float(run[f"block{i + 1}.omega"][:_course(run, i)[1] + 1].max())


def _peak(i: int) -> Callable[[Recording], float]:
    def found(run: Recording) -> float:
        tilt, _, peak, _ = _course(run, i)
        return float(-tilt[peak] / BLOCKS[i].slender)

    return found


def _share(block: Block) -> float:
    """By how much the peak may be off, in steps [1/s].

    Of the rate w after the blow p² sin α h is lost or gained in each step that the blow is early
    or late, three at most; by the energy the peak hangs on it as w / (p² α² (1 - peak)).
    """
    return float(3 * block.kept * block.rate / (block.slender * (1 - block.peak)))


def _later(block: Block) -> float:
    """By how much the second fall may be late, in steps, from cosh(p t) = 1/(1 - peak)."""
    left = 1 - block.peak
    return float(1 + 2 * _share(block) / (left * (block.turning * (1 - left**2))**0.5))


def _digits(what: str, expected: Callable[[Block], float],
            found: Callable[[int], Callable[[Recording], float]]) -> list[Digit]:
    return [Digit(f"{b.width:g} × {b.height:g} m, {b.tilt:g} α: {what}", expected(b), found(i))
            for i, b in enumerate(BLOCKS)]


LANDING = ("the blow falls somewhere in its step, or is shared by two; what gravity does to the "
           "rate in three steps")
ROCKING_BLOCK = Benchmark(
    "rocking_block", "Rocking block",
    "A block on a rough floor, tilted by a share of the angle α at which it would stand on its "
    "corner, rocks: about one corner, flat, about the other. At each blow the rate is left with "
    "1 − 1.5 sin²α of what it was, by moments about the corner that hits.",
    "Housner (1963). Instants and peaks by an integration of order 8.",
    "Friction is 1.5 and not infinite, which is enough.",
    scene, (5e-4, 2e-4, 1e-4),
    (Criterion("instants of the first fall", "s",
               _digits("flat", lambda b: b.flat, lambda i: _flat(i, False)), 1.0, 1.0,
               "an instant is known to its step", 1.0, steady=False),
     Criterion("rates before the blow", "rad/s",
               _digits("rate", lambda b: b.rate, _rate),
               1.0, 2 * max(b.turning * b.slender for b in BLOCKS),
               "of the last sample before the blow, up to two steps of p² α early", 1.0,
               steady=False),
     Criterion("peaks after it", "α", _digits("next peak", lambda b: b.peak, _peak),
               1.0, max(_share(b) for b in BLOCKS), LANDING, 1.0, steady=False),
     Criterion("instants of the second fall", "s",
               _digits("flat again", lambda b: b.again, lambda i: _flat(i, True)),
               1.0, max(_later(b) for b in BLOCKS),
               f"the first fall's, and what the peak's makes of it; {LANDING}", 1.0,
               steady=False)),
    {"bodies[block2].shapes[0].size[0]": 0.206}, quick=(1e-3, 5e-4))
BENCHMARKS = (ROCKING_BLOCK,)
