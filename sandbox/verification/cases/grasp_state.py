"""Two phalanges on a fixed object: which contacts hold, where a finger that lets go slides to.

The cord runs over a wheel on the knuckle and is wound on one of the distal phalanx,
so its arms, and with them the equilibrium curve, are the same in every pose. What
begins on the wrong side of the curve slides along the object until the first joint
is in balance, a stop takes it up or the contact runs off the tip.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics.chain import inverse, pose, to_world, transforms
from sandbox.mechanics.grasp_state import (
    GraspState,
    TwoPhalanges,
    ejection_path,
    grasp_states,
)
from sandbox.mechanics.transmission import equilibrium_distance, two_phalanx_forces
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.study.plain_mechanisms import cord, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

NAMES, HINGES = ("proximal", "distal"), ("knuckle", "joint")
LENGTHS, MASSES, RADIUS = (0.045, 0.030), (0.012, 0.006), 0.005
"""Of the phalanges [m], [kg], [m]."""
ARMS, EYE = (0.012, 0.0051), (-0.03, 0.03)
"""Radii of the wheels on the hinges, and where the cord comes out of the palm [m]."""
PULL = 3.0
"""[N]"""
LOWER, UPPER = (0.0, 0.0), (1.5, 1.25)
"""Stops [rad]."""
OBJECT, PEG = 0.008, 0.005
"""Radii of what the distal and of what the proximal phalanx touches [m]."""
K_1 = 0.02
"""Of the peg from the first hinge, along the phalanx [m]."""
OVERLAP = 1e-8
"""Left to a contact by a step at 1 rad/s: h^2 r / 2 is 4e-9 for 30 mm and 0.5 ms [m]."""
STOPPED = 1e-12
"""Rounding of an angle at its stop [rad]."""
FINGER = TwoPhalanges(
    LENGTHS, lambda theta: np.broadcast_to(np.multiply(PULL, ARMS), theta.shape), LOWER, UPPER,
    apart=OBJECT + RADIUS)


@dataclass(frozen=True)
class Start:
    """A pose in which both phalanges touch."""

    theta: tuple[float, float]
    """[rad]"""
    k_2: float
    """Of the object from hinge 2, along the phalanx [m]."""

    @property
    def centre(self) -> Array:
        """Of the object, in the world [m]."""
        frames = transforms(self.theta, LENGTHS)
        return np.asarray(to_world(frames, [(0.0, 0.0), (self.k_2, -FINGER.apart)])[1])

    def sunk(self, by: float) -> Start:
        """The same object and theta_2, the distal phalanx closer to its centre by so much [m]."""
        closer = replace(FINGER, apart=FINGER.apart - by)
        length, theta_2 = LENGTHS[0], self.theta[1]
        away = complex(*self.centre)
        across = closer.apart - length * np.sin(theta_2)
        k_2 = float(np.sqrt(abs(away)**2 - across**2) - length * np.cos(theta_2))
        straight = length + (k_2 - 1j * closer.apart) * np.exp(-1j * theta_2)
        return Start((float(-np.angle(away / straight)), theta_2), k_2)


STARTS = {
    GraspState.STABLE: (Start((0.6, 0.8), 0.026), Start((0.6, 1.1), 0.019)),
    GraspState.EQUILIBRIUM: (Start((0.6, 0.6), 0.010), Start((0.9, 0.5), 0.006)),
    GraspState.STOP: (Start((0.6, 1.1), 0.004),),
    GraspState.EJECTS: (Start((0.6, 0.1), 0.0275),),
}
"""By what is to become of them."""
WORDS = {GraspState.STABLE: "held by both", GraspState.EQUILIBRIUM: "held by the distal one",
         GraspState.STOP: "held by a stop", GraspState.EJECTS: "ejected"}


def machine(start: Start) -> Mechanism:
    """The finger with a fixed peg under its first phalanx and a fixed disc under its second."""
    frames = transforms(start.theta, LENGTHS)
    peg = to_world(frames, [(K_1, -RADIUS - PEG), (0.0, 0.0)])[0]
    angles = -np.cumsum(start.theta)
    bodies = [fixed("palm"), *({
        "name": name, "at": tuple(frames[i, :2, 2]), "angle": angles[i], "mass": MASSES[i],
        "centre": (LENGTHS[i] / 2, 0.0), "inertia": MASSES[i] * LENGTHS[i]**2 / 12,
        "material": "smooth",
        "shapes": [{"type": "capsule", "end": (LENGTHS[i], 0.0), "radius": RADIUS}],
    } for i, name in enumerate(NAMES)), *(
        fixed(name, at=tuple(at), material="smooth", shapes=[{"type": "circle", "radius": radius}])
        for name, at, radius in (("object", start.centre, OBJECT), ("peg", peg, PEG)))]
    joints = [{"type": "pin", "name": HINGES[i], "a": before, "b": NAMES[i], "on_b": (0.0, 0.0),
               "positive": "clockwise", "limits": (LOWER[i], UPPER[i]), "damping": 2e-3}
              for i, before in enumerate(("palm", "proximal"))]
    return mechanism(
        duration=2.0, bodies=bodies, joints=joints,
        tendons=[cord("tendon", ("distal", (0.0, 0.0), ARMS[1], "right"),
                      ("palm", (0.0, 0.0), ARMS[0], "right"), ("palm", EYE))],
        drives=[{"type": "pull", "name": "pull", "tendon": "tendon", "value": PULL}],
        materials={"smooth": {"friction": 0.0}},
        contacts=[{"between": ("*", "*"), "collide": False},
                  {"between": ("object", "distal"), "collide": True},
                  {"between": ("peg", "proximal"), "collide": True}])


def _along(run: Recording, start: Start) -> Array:
    """k_2 of every sample [m]: where along the distal phalanx the object's centre lies."""
    at = run.arrays["body_pose"][:, run.catalogue.elements["distal"].index]
    frames = inverse(pose(at[:, 0], at[:, 1], at[:, 2]))
    return np.asarray(frames[:, 0, :2] @ start.centre + frames[:, 0, 2])


def _checks(expected: GraspState, start: Start, run: Recording) -> list[Check]:
    """What the closed form says of one pose against where the engine's finger ends."""
    (first, second), found = start.theta, np.stack([run[f"{h}.angle"] for h in HINGES], axis=1)
    ends = [grasp_states(replace(FINGER, apart=FINGER.apart - by), theta_1=pose_.theta[0],
                         theta_2=pose_.theta[1], k_1=K_1, k_2=pose_.k_2)
            for by in (0.0, 2 * OVERLAP) for pose_ in [start.sunk(by)]]
    state, end = GraspState(int(ends[0].state)), ends[0].theta
    allowed = np.abs(ends[1].theta - end) + STOPPED
    why = "the closed form with the contact sunk by twice the 10 nm that a moving one may have"
    last = found[-1]
    if state == GraspState.STABLE:
        allowed = np.array([2 * OVERLAP / K_1, 2 * OVERLAP / K_1 + 2 * OVERLAP / start.k_2])
        why = "contacts sink in by up to 10 nm, k₁ and k₂ from their hinges"
    elif state == GraspState.EJECTS:  # where the contact runs off the tip, between two samples
        last = np.array([np.interp(end[1], found[:, 1], found[:, 0]),
                         np.interp(LENGTHS[1], _along(run, start), found[:, 1])])
    label = (f"{WORDS[expected]}, from {np.degrees(first):.0f}°, {np.degrees(second):.0f}°, "
             f"{1e3 * start.k_2:g} mm")
    checks = [Check(f"{label}: grasp state", "1", float(expected), float(state), 0.0,
                    "what this pose is here for")]
    checks += [Check(f"{label}: angle {i + 1}", "rad", float(end[i]), float(last[i]),
                    float(allowed[i]), why) for i in range(2)]
    if state == GraspState.EJECTS:
        return checks
    tau = FINGER.torques(end)
    forces = two_phalanx_forces(end[1], K_1, ends[0].k_2, LENGTHS[0], tau[0], tau[1])
    near = float(forces.proximal) if state == GraspState.STABLE else 0.0
    checks.append(Check(f"{label}: force on the proximal phalanx", "N", near,
                        float(run["peg/proximal.normal"][-1]), 1e-4 * float(forces.distal),
                        "four digits of the distal force"))
    if state != GraspState.STOP:
        checks.append(Check(f"{label}: force on the distal phalanx", "N", float(forces.distal),
                            float(run["object/distal.normal"][-1]), 1e-4 * float(forces.distal),
                            "four digits; sinking turns the joints by 1e-6 rad"))
    return checks


def _grasp_states() -> Findings:
    theta_2 = np.linspace(0.05, UPPER[1], 121)
    edge = equilibrium_distance(theta_2, LENGTHS[0], ARMS[1] / ARMS[0])
    checks: list[Check] = []
    gap = np.full((2, 1), np.nan)
    curves = [Curve("equilibrium curve", 1e3 * edge, np.degrees(theta_2), "dashed")]
    for expected, starts in STARTS.items():
        lines: list[Array] = []
        marks: list[Array] = []
        for start in starts:
            run = simulate(machine(start))
            checks += _checks(expected, start, run)
            path = ejection_path(FINGER, theta_1=start.theta[0], theta_2=start.theta[1],
                                 k_2=start.k_2)
            lines += [np.stack([1e3 * path.k_2, np.degrees(path.theta[:, 1])]), gap]
            marks.append(_marks(run, start))
        line, mark = np.concatenate(lines, axis=1), np.concatenate(marks, axis=1)
        curves += [Curve(f"{WORDS[expected]}, closed form", line[0], line[1]),
                   Curve(f"{WORDS[expected]}, engine", mark[0], mark[1], "points")]
    return Findings(checks, [Panel("Where a pose with both contacts ends", "k₂ [mm]", "θ₂ [deg]",
                                   curves)])


def _marks(run: Recording, start: Start) -> Array:
    """k_2 [mm] and theta_2 [deg] of the engine where theta_2 has gone on by 5 degrees each time."""
    k_2, theta_2 = _along(run, start), np.degrees(run["joint.angle"])
    shown = theta_2[k_2 <= LENGTHS[1]]
    steps = np.unique(np.searchsorted(np.maximum.accumulate(shown), np.arange(0, 90, 5.0)))
    rows = np.append(steps[(steps > 0) & (steps < len(shown) - 1)], len(shown) - 1)
    return np.stack([1e3 * k_2[rows], theta_2[rows]])


CASES = (
    Case("grasp_states", "Grasp states of two phalanges",
         "k₂ > X l₁ cos θ₂ / (1 − X), X = τ₂/τ₁",
         "two phalanges of 45 and 30 mm under 3 N, without friction, on a fixed disc and a fixed "
         "peg; 2 s, h = 0.5 ms",
         "whether both contacts hold and where the finger ends with the grasp-state map",
         _grasp_states),
)
