"""Rods in a row: a long chain, light links that carry heavy ones, energy for a minute."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.measures import GAP, closed
from tests.hard.trial import AtMost, Measure, Order, Target, Trial, spell
from tests.hard.truth.chains import G, Rods

SECOND_ORDER = "the leapfrog is of second order; a tenth is left for what is next to it"


def chain(rods: Rods, duration: float, step: float, **more: Any) -> Mechanism:
    """The rods as bodies whose frames sit at their near pins."""
    ends = np.concatenate([np.zeros((1, 2)), np.cumsum(
        rods.length * np.stack([np.cos(rods.start), np.sin(rods.start)], 1), axis=0)])
    half = (rods.length / 2, 0.0)
    links = [{"name": f"link{i}", "mass": m, "inertia": float(rods.inertias[i]), "centre": half,
              "at": tuple(ends[i].tolist()), "angle": rods.start[i]}
             for i, m in enumerate(rods.masses)]
    pins = [{"type": "pin", "name": f"pin{i}", "a": f"link{i - 1}" if i else "wall",
             "b": f"link{i}", "on_b": (0.0, 0.0)} for i in range(len(links))]
    return spell(duration, step, gravity=(0.0, -G), joints=pins,
                 bodies=[{"name": "wall", "motion": "fixed"}, *links], **more)


def angles(run: Recording, count: int, quantity: str = "angle") -> np.ndarray:
    return np.stack([run[f"link{i}.{quantity}"] for i in range(count)], axis=1)


def tip_error(rods: Rods) -> Measure:
    last = len(rods.masses) - 1

    def of(run: Recording) -> float:
        angle = run[f"link{last}.angle"]
        tip = np.stack([run[f"link{last}.x"] + rods.length * np.cos(angle),
                        run[f"link{last}.y"] + rods.length * np.sin(angle)], axis=1)
        return float(np.linalg.norm(tip - rods.tip(rods.angles(run.time)), axis=1).max())

    return Measure("tip error", "m", of)


def angle_error(rods: Rods) -> Measure:
    def of(run: Recording) -> float:
        found = angles(run, len(rods.masses))
        return float(np.abs(found - rods.angles(run.time)).max())

    return Measure("angle error", "rad", of)


def _chain_of_20() -> Trial:
    rods = Rods((0.01,) * 20, 0.02, (0.0,) * 20)
    return Trial(
        "chain_20", "20 links of 20 mm and 10 g, released level, 0.4 s",
        lambda step: chain(rods, 0.4, step), (tip_error(rods), GAP),
        (AtMost("tip error", 5e-4, 2.5e-4, "asked; 0.1 mm is the aim"),
         Order("tip error", (2.5e-4, 1e-4), 1.8, SECOND_ORDER), closed(5e-4)))


def _pendulum(ratio: int) -> Trial:
    rods = Rods((0.1 / ratio, 0.1), 0.1, (-0.3, -1.0))
    return Trial(
        f"pendulum_{ratio}", f"two-link pendulum, the upper link 1:{ratio} of the lower, 2 s",
        lambda step: chain(rods, 2.0, step, sample_rate=1000.0), (angle_error(rods), GAP),
        (AtMost("angle error", 5e-4, 1.5e-3, "asked; 3e-4 is the aim"),
         Order("angle error", (5e-4, 2.5e-4), 1.8, SECOND_ORDER), closed(5e-4)))


def _minute() -> Trial:
    rods = Rods((0.1, 0.1), 0.1, (0.5, 1.0))
    span = 2 * G * rods.length * sum(rods.masses)

    def energies(run: Recording) -> np.ndarray:
        """Off the first of a chain at rest, as a share of all that weight can give it."""
        start = np.array([rods.start])
        now = rods.energy(angles(run, 2), angles(run, 2, "omega"))
        return (now - rods.energy(start, 0 * start)) / span

    def drift(run: Recording) -> float:
        off, early = energies(run), run.time < 10.0
        return float(abs(off[run.time > 50.0].mean() - off[early].mean()))

    why = ("with the joints closed at the end of the step the scheme is symplectic: energy swings "
           "with (w h)^2 and goes nowhere; closed to first order it loses h^3 a second")
    targets: tuple[Target, ...] = (
        AtMost("energy error", 5e-4, 1e-3, why), AtMost("energy drift", 5e-4, 1e-4, why))
    return Trial(
        "double_pendulum", "two equal links, chaotic, energy over 60 s",
        lambda step: chain(rods, 60.0, step, sample_rate=200.0),
        (Measure("energy error", "", lambda run: float(np.abs(energies(run)).max())),
         Measure("energy drift", "", drift)), targets)


def trials() -> list[Trial]:
    return [_chain_of_20(), _pendulum(1000), _minute()]
