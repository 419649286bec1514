"""An eccentric cam under a flat follower: the force of the contact, and where it is lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks.benchmark import (
    Benchmark,
    Criterion,
    Digit,
    Json,
    at,
    spelled,
)

G, ECCENTRIC, MASS, RADIUS, APART, LENGTH = 9.81, 0.01, 0.2, 0.03, 0.3, 0.3


@dataclass(frozen=True)
class Cam:
    """A cam, its follower's spring, and its speed as a share of that at which it lifts off."""

    name: str
    stiffness: float
    pressed: float
    """Of the spring at the lowest place [m]."""
    limit: float
    """At which the contact is lost [rad/s]."""
    share: float

    @property
    def rate(self) -> float:
        """[rad/s]."""
        return self.limit * self.share

    def force(self, sine: float) -> float:
        """Of the contact, at the sine of the cam's angle from level [N]."""
        return (MASS * (G - ECCENTRIC * self.rate**2 * sine)
                + self.stiffness * (self.pressed + ECCENTRIC * (1 + sine)))

    def lifts(self) -> float:
        """The cam's angle at which the force is gone [rad]."""
        held = MASS * G + self.stiffness * (self.pressed + ECCENTRIC)
        return float(np.arcsin(held / (MASS * ECCENTRIC * self.rate**2
                                       - self.stiffness * ECCENTRIC)))


SPRUNG, BARE = 85.0352868, 31.3209195
CAMS = (Cam("sprung", 500.0, 0.005, SPRUNG, 0.5), Cam("bare", 0.0, 0.0, BARE, 0.5),
        Cam("sprung_below", 500.0, 0.005, SPRUNG, 0.99), Cam("bare_below", 0.0, 0.0, BARE, 0.99),
        Cam("sprung_above", 500.0, 0.005, SPRUNG, 1.1), Cam("bare_above", 0.0, 0.0, BARE, 1.1))
FORCES = {"sprung": (10.8465, 8.0775), "bare": (1.4715, 2.4525)}
"""At the top and at the bottom [N]."""
TURNS = 2


def scene(step: float) -> Json:
    """Six cams beside one another, all of which begin level."""
    bodies: list[Json] = [{"name": "frame", "motion": "fixed"}]
    joints, springs = [], []
    for i, cam in enumerate(CAMS):
        x, follower = APART * i, f"{cam.name}_follower"
        bodies += [
            {"name": cam.name, "motion": "scheduled", "at": [x, 0.0], "material": "smooth",
             "path": {"angle": f"={cam.rate!r} * t"},
             "shapes": [{"type": "circle", "radius": RADIUS, "at": [ECCENTRIC, 0.0]}]},
            {"name": follower, "mass": MASS, "inertia": 1e-4, "at": [x, RADIUS],
             "velocity": [0.0, ECCENTRIC * cam.rate], "material": "smooth",
             "shapes": [{"type": "box", "size": [0.1, 0.01], "at": [0.0, 0.005]}]}]
        joints.append({"type": "slot", "name": f"{cam.name}_guide", "a": "frame", "b": follower,
                       "start": [x, 0.0], "end": [x, 0.2], "turns": False})
        if cam.stiffness:
            springs.append({
                "type": "linear", "name": f"{cam.name}_spring", "a": "frame", "b": follower,
                "on_a": [x, RADIUS + LENGTH], "stiffness": cam.stiffness,
                "rest_length": LENGTH + cam.pressed + ECCENTRIC})
    return spelled(TURNS * 2 * np.pi / CAMS[1].rate, step, gravity=[0.0, -G], bodies=bodies,
                   joints=joints, springs=springs, materials={"smooth": {"friction": 0.0}})


def _pair(cam: Cam) -> str:
    return f"{cam.name}_follower/{cam.name}.normal"


def _half(cam: Cam) -> list[Digit]:
    """In the second turn."""
    turn = 2 * np.pi / cam.rate
    return [at(_pair(cam), (1.25 + i / 2) * turn, force, f"{cam.name}: {place}")
            for i, (place, force) in enumerate(zip(("top", "bottom"), FORCES[cam.name],
                                                   strict=True))]


def _least(cam: Cam) -> Digit:
    """In the second turn and the half before it."""
    def found(run: Recording) -> float:
        turn = 2 * np.pi / cam.rate
        return float(run[_pair(cam)][(run.time > turn / 2) & (run.time < 2 * turn)].min())

    return Digit(f"{cam.name}: least force", cam.force(1.0), found)


def _lifts(cam: Cam) -> Digit:
    """Between the last sample with a force and the first without, in the first turn."""
    def found(run: Recording) -> float:
        k = int(np.argmax(run[_pair(cam)] <= 0))
        return float(cam.rate * (run.time[k - 1] + run.time[k]) / 2)

    return Digit(f"{cam.name}: lifts off", cam.lifts(), found)


FAST = max(cam.rate for cam in CAMS)
SWING = MASS * ECCENTRIC * SPRUNG**2
HALF = CAMS[0].rate
ECCENTRIC_CAM = Benchmark(
    "cam", "Eccentric cam with a flat follower",
    "A disc turns about a point 10 mm beside its centre and lifts a flat follower of 200 g, with "
    "a spring of 500 N/m or without one. The contact is lost from ω² = (m g + k (p + 2 e))/(m e) "
    "on: 85.035 rad/s with the spring, 31.321 without.",
    "Textbook; closed form.",
    "Run at half that speed, at 0.99 and at 1.1 of it; looked at from the first half turn on.",
    scene, (5e-4, 2.5e-4, 1.25e-4),
    (Criterion("forces at top and bottom, half speed", "N",
               [digit for cam in CAMS[:2] for digit in _half(cam)],
               SWING / 4, HALF, "m e ω² (h ω)², at half of 85 rad/s"),
     Criterion("least force at 0.99 of the speed", "N", [_least(cam) for cam in CAMS[2:4]],
               SWING, SPRUNG, "m e ω² (h ω)²; and the top lies between two samples",
               2.0, steady=False),
     Criterion("angles of lift-off at 1.1 of it", "rad", [_lifts(cam) for cam in CAMS[4:]],
               1.0, FAST, "the step in which it happens: ω h", 1.0, steady=False)),
    {"bodies[sprung_follower].mass": 1.01 * MASS})
BENCHMARKS = (ECCENTRIC_CAM,)
