"""A disc that rolls off another one: where it slips, and where it leaves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

G, HILL, RADIUS, START, APART = 9.81, 0.2, 0.05, 0.1, 1.0
ARM = HILL + RADIUS
"""From centre to centre [m]."""
GRIP = 1e3
"""Friction of those that roll to the end."""


@dataclass(frozen=True)
class Rolling:
    """A disc, its inertia k m r², and where it leaves or slips [deg]."""

    name: str
    says: str
    inertia: float
    friction: float
    angle: float

    @property
    def share(self) -> float:
        """The inertia of what rolls, 0 of what glides."""
        return self.inertia if self.friction else 0.0

    def rate(self, angle: float) -> float:
        """Of the line of centres, that far from the top [rad/s]."""
        return float(np.sqrt(2 * G * (1 - np.cos(angle)) / (ARM * (1 + self.share))))


LEAVES = (Rolling("disc", "disc, rolling", 0.5, GRIP, 55.1500954),
          Rolling("hoop", "hoop, rolling", 1.0, GRIP, 60.0),
          Rolling("smooth", "smooth", 0.5, 0.0, 48.1896851))
ONSET = {0.1: 15.863225, 0.3: 33.477666, 0.5: 40.725846, 1.0: 47.419996}
"""Where a disc begins to slip [deg], by friction."""
SLIPS = tuple(Rolling(f"slips{i + 1}", f"μ = {mu:g}", 0.5, mu, angle)
              for i, (mu, angle) in enumerate(ONSET.items()))
CLOSE = np.radians(47.0)
"""Up to where forces are compared [rad]."""
SETTLED = 2
"""Samples that are left out: a contact that begins in motion."""


def scene(step: float) -> Json:
    """Each on a hill of its own, 0.1 rad from the top, as fast as if it came from there."""
    bodies, rules = [], []
    for i, one in enumerate((*LEAVES, *SLIPS)):
        u, speed = one.rate(START), one.rate(START) * ARM
        bodies += [
            {"name": f"{one.name}_hill", "motion": "fixed", "at": [APART * i, 0.0],
             "shapes": [{"type": "circle", "radius": HILL}]},
            {"name": one.name, "mass": 1.0, "inertia": one.inertia * RADIUS**2,
             "at": [APART * i + ARM * np.sin(START), ARM * np.cos(START)],
             "velocity": [speed * np.cos(START), -speed * np.sin(START)],
             "angular_velocity": -u * ARM / RADIUS if one.friction else 0.0,
             "shapes": [{"type": "circle", "radius": RADIUS}]}]
        rules.append({"between": [one.name, f"{one.name}_hill"], "friction": one.friction})
    return spelled(0.7, step, gravity=[0.0, -G], bodies=bodies, contacts=rules)


def _contact(run: Recording, one: Rolling) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle from the top [rad], N and |F| in weights."""
    centre = APART * (*LEAVES, *SLIPS).index(one)
    pair = f"{one.name}/{one.name}_hill"
    return (np.arctan2(run[f"{one.name}.x"] - centre, run[f"{one.name}.y"]),
            run[f"{pair}.normal"] / G, np.abs(run[f"{pair}.tangential"]) / G)


def _event(one: Rolling) -> Callable[[Recording], float]:
    """In the middle of the samples before and after."""
    def found(run: Recording) -> float:
        angle, normal, along = _contact(run, one)
        now = normal <= 0 if one in LEAVES else along >= one.friction * normal * (1 - 1e-9)
        k = int(np.argmax(now))
        return float(np.degrees(angle[k - 1] + angle[k]) / 2)

    return found


def _force(one: Rolling) -> Callable[[Recording], float]:
    """The largest error of N in any sample up to 47 degrees."""
    def found(run: Recording) -> float:
        angle, normal, _ = _contact(run, one)
        a = angle[SETTLED:int(np.argmax(angle > CLOSE))]
        truth = np.cos(a) - 2 * (1 - np.cos(a)) / (1 + one.share)
        return float(np.abs(normal[SETTLED:SETTLED + len(a)] - truth).max())

    return found


FAST = max(one.rate(float(np.radians(one.angle))) for one in LEAVES)
ROLLING_DISC = Benchmark(
    "rolling_disc", "Disc rolling off a disc",
    "A disc on top of a fixed one begins to roll down, N = m g (cos θ − 2 (1 − cos θ)/(1 + k)), "
    "and leaves at cos θ = 4/7; a hoop at 1/2, a smooth disc at 2/3. With less friction it slips "
    "before.",
    "Textbook; closed form.",
    "It is met at 0.1 rad, as fast as it is there. Of a contact that begins in motion the first "
    "two samples are off, by half of the centripetal force, up and down, whatever the step; they "
    "are left out.",
    scene, (1e-3, 5e-4, 2.5e-4),
    (Criterion("N, every sample up to 47°", "weights",
               [Digit(f"{one.says}: largest error", 0.0, _force(one)) for one in LEAVES],
               3.0, (G / ARM)**0.5, "N falls by (1 + 2/(1 + k)) m g for 1 − cos θ, 3 at most; "
               "rate √(g/(R + r)), at which it leaves the top"),
     Criterion("angles at which they leave", "deg",
               [Digit(one.says, one.angle, _event(one)) for one in LEAVES],
               np.degrees(1.0), FAST, "the step in which it happens: θ' h", 1.0, steady=False),
     Criterion("angles at which slip begins", "deg",
               [Digit(one.says, one.angle, _event(one)) for one in SLIPS],
               np.degrees(1.0), FAST, "the step in which it happens: θ' h", 1.0, steady=False)),
    {"bodies[disc].inertia": 0.505 * RADIUS**2})
BENCHMARKS = (ROLLING_DISC,)
