"""Fingers on objects: which contacts hold, where a finger slides to, forces of published hands.

A contact can only push. To measure the force of every contact, also where it would have to pull,
phalanges are held by rigid rods along the contact normals in place of an object.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sandbox.engine.simulate import simulate
from sandbox.mechanics.chain import pose, to_world, transforms
from sandbox.mechanics.grasp_state import GraspState, TwoPhalanges, grasp_states
from sandbox.mechanics.statics import contact_forces, contact_jacobian
from sandbox.mechanics.transmission import two_phalanx_forces
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene
from tests.support.mechanisms import Json, cable, fixed, mechanism, pin

from .case import Check, case

OBJECT, RADIUS = 0.008, 0.005
"""Radius of the object, and half the thickness of the phalanges [m]."""
SINKS = 2e-8
"""Twice the penetration of a contact that moves at 1 rad/s: h^2 r / 2 < 1e-8 m."""
DIGIT = "half of the last digit"


def links(theta: Sequence[float], lengths: Sequence[float], shapes: Sequence[list[Json]],
          masses: Sequence[float] = (0.01,) * 3, limits: Sequence[Any] = (None,) * 3,
          ) -> dict[str, list[Any]]:
    """Phalanges on hinges from the palm at the origin, closing clockwise."""
    frames, angles = transforms(theta, lengths), -np.cumsum(theta)
    bodies, joints = [fixed("palm")], []
    for i, length in enumerate(lengths):
        bodies.append({
            "name": f"phalanx{i + 1}", "at": tuple(frames[i, :2, 2]), "angle": angles[i],
            "mass": masses[i], "centre": (length / 2, 0.0), "inertia": masses[i] * length**2 / 12,
            "material": "smooth", "shapes": shapes[i]})
        joints.append(pin(f"hinge{i + 1}", f"phalanx{i}" if i else "palm", f"phalanx{i + 1}",
                          positive="clockwise", limits=limits[i], damping=2e-3))
    return {"bodies": bodies, "joints": joints}


def pulled(duration: float, pull: float, tendon: Json, parts: Mapping[str, Any],
           *touching: tuple[str, str]) -> Recording:
    """Recording of a finger under a constant pull; only these pairs touch."""
    return simulate(mechanism(
        duration=duration, **parts, tendons=[tendon], materials={"smooth": {"friction": 0.0}},
        drives=[{"type": "pull", "name": "pull", "tendon": "tendon", "value": pull}],
        contacts=[{"between": ("*", "*"), "collide": False},
                  *({"between": pair, "collide": True} for pair in touching)]))


def wound(arms: Sequence[float]) -> Json:
    """Tendon on wheels of two hinges: its arms are the wheels' radii in every pose."""
    return cable("tendon", ("phalanx2", (0.0, 0.0), arms[1], "right"),
                ("palm", (0.0, 0.0), arms[0], "right"), ("palm", (-0.03, 0.03)))


def disc(name: str, at: ArrayLike, radius: float) -> Json:
    return fixed(name, at=tuple(np.asarray(at)), material="smooth",
                 shapes=[{"type": "circle", "radius": radius}])


def along(run: Recording, centre: ArrayLike) -> Array:
    """Distance k_2 of a point [m] from hinge 2 along phalanx 2, at every sample [m]."""
    frames = np.linalg.inv(pose(*(run[f"phalanx2.{key}"] for key in ("x", "y", "angle"))))
    return np.asarray(frames[:, 0, :2] @ centre + frames[:, 0, 2])


LENGTHS, ARMS, PULL, K_1 = (0.045, 0.030), (0.012, 0.0051), 3.0, 0.02
"""Of the finger with both contacts; the peg lies at K_1 from hinge 1."""
FINGER = TwoPhalanges(
    LENGTHS, lambda theta: np.broadcast_to(np.multiply(PULL, ARMS), theta.shape), (0.0, 0.0),
    (1.5, 1.25), apart=OBJECT + RADIUS)


@dataclass(frozen=True)
class Pose:
    """Pose [rad] in which both phalanges touch; the object is at k_2 [m] along phalanx 2."""

    theta: tuple[float, float]
    k_2: float

    @property
    def centre(self) -> Array:
        """Of the object [m]."""
        return np.asarray(to_world(transforms(self.theta, LENGTHS),
                                   [(0.0, 0.0), (self.k_2, -FINGER.apart)])[1])

    def sunk(self, by: float) -> Pose:
        """The same object and theta_2, phalanx 2 closer to its centre [m]."""
        apart, length, theta_2 = FINGER.apart - by, LENGTHS[0], self.theta[1]
        away = complex(*self.centre)
        across = apart - length * np.sin(theta_2)
        k_2 = float(np.sqrt(abs(away)**2 - across**2) - length * np.cos(theta_2))
        straight = length + (k_2 - 1j * apart) * np.exp(-1j * theta_2)
        return Pose((float(-np.angle(away / straight)), theta_2), k_2)


@case("Grasp states of two phalanges", "k₂ > X l₁ cos θ₂ / (1 − X), X = τ₂/τ₁",
      "two phalanges of 45 and 30 mm under 3 N, without friction, on a fixed disc and a fixed peg; "
      "2 s, h = 0.5 ms")
def test_grasp_states() -> Iterator[Check]:
    """A pose beyond the equilibrium curve slides to it, to a limit or off the tip."""
    for expected, theta, k_2 in (
            (GraspState.STABLE, (0.6, 0.8), 0.026), (GraspState.STABLE, (0.6, 1.1), 0.019),
            (GraspState.EQUILIBRIUM, (0.6, 0.6), 0.010),
            (GraspState.EQUILIBRIUM, (0.9, 0.5), 0.006),
            (GraspState.STOP, (0.6, 1.1), 0.004), (GraspState.EJECTS, (0.6, 0.1), 0.0275)):
        start = Pose(theta, k_2)
        parts = links(theta, LENGTHS, [[{"type": "capsule", "end": (length, 0.0), "radius": RADIUS}]
                                       for length in LENGTHS], (0.012, 0.006),
                      list(zip(FINGER.lower, FINGER.upper, strict=True)))
        peg = to_world(transforms(theta, LENGTHS), [(K_1, -RADIUS - 0.005), (0.0, 0.0)])[0]
        parts["bodies"] += [disc("object", start.centre, OBJECT), disc("peg", peg, 0.005)]
        run = pulled(2.0, PULL, wound(ARMS), parts, ("object", "phalanx2"), ("peg", "phalanx1"))
        angles = np.stack([run["hinge1.angle"], run["hinge2.angle"]], axis=1)
        first, other = (grasp_states(
            replace(FINGER, apart=FINGER.apart - by), theta_1=each.theta[0], theta_2=each.theta[1],
            k_1=K_1, k_2=each.k_2) for by in (0.0, SINKS) for each in [start.sunk(by)])
        state, end, last = GraspState(int(first.state)), first.theta, angles[-1]
        allowed = np.abs(other.theta - end) + 1e-12
        if state == GraspState.STABLE:
            allowed = np.cumsum([SINKS / K_1, SINKS / k_2])
        elif state == GraspState.EJECTS:  # where the contact runs off the tip, between samples
            last = np.array([np.interp(end[1], angles[:, 1], angles[:, 0]), np.interp(
                LENGTHS[1], along(run, start.centre), angles[:, 1])])
        label = f"{expected.name.lower()}, k₂ = {1e3 * k_2:g} mm"
        yield Check(f"{label}: grasp state", "1", float(expected), float(state), 0.0, "by choice")
        yield Check(f"{label}: angles", "rad", end, last, allowed,
                    "contacts sunk in by twice the 10 nm of a moving one")
        if state == GraspState.EJECTS:
            continue
        forces = two_phalanx_forces(end[1], K_1, first.k_2, LENGTHS[0], *FINGER.torques(end))
        wanted = {"peg/phalanx1": forces.proximal if state == GraspState.STABLE else 0.0,
                  "object/phalanx2": forces.distal}
        if state == GraspState.STOP:
            del wanted["object/phalanx2"]
        yield Check(f"{label}: forces", "N", [float(force) for force in wanted.values()],
                    [run[f"{pair}.normal"][-1] for pair in wanted], 1e-4 * float(forces.distal),
                    "four digits of the distal force; sinking turns the joints by 1e-6 rad")


SLIDES = ((60, 0, 67.482175), (65, 0, 61.341819), (70, 0, 55.550098), (75, 0, 49.797034),
          (60, 18, 56.556353), (65, 18, 52.159842))
"""Distance of the object from hinge 1 and from the phalanx's axis [mm], and theta_2 [deg] at rest,
computed independently."""


def sliding(distance: float, across: float) -> tuple[Recording, Array]:
    """Phalanx 2 alone on a fixed disc, whose centre is ``across`` its axis [m]; k_2 over time [m].

    At 0 it is the thin finger on a point of the closed form.
    """
    begin, (near, far) = np.radians([40.0, 20.0]), (0.050, 0.0333)
    k_2 = np.sqrt(distance**2 - (near * np.sin(begin[1]) - across)**2) - near * np.cos(begin[1])
    skin = OBJECT + RADIUS - across
    parts = links(begin, (near, far), [[{"type": "circle", "radius": RADIUS}], [
        {"type": "capsule", "start": (0.0, skin), "end": (far + 0.005, skin), "radius": RADIUS}]])
    centre = to_world(transforms(begin, (near, far)), [(0.0, 0.0), (k_2, -across)])[1]
    parts["bodies"].append(disc("object", centre, OBJECT))
    run = pulled(3.0, 10.0, wound((0.012, 0.006)), parts, ("object", "phalanx2"))
    return run, along(run, centre)


@case("Slides that end on the equilibrium curve, or off the tip",
      "k₂ = l₁ cos θ₂ (X = 1/2), ρ² = (k₂ + l₁ cos θ₂)² + (l₁ sin θ₂ − d)²",
      "two phalanges of 50 and 33.3 mm, arms of 12 and 6 mm, 10 N, released at θ₂ = 20° with the "
      "distal phalanx alone on a smooth fixed object; 3 s, h = 0.5 ms")
def test_ejection() -> Iterator[Check]:
    near, far = 0.050, 0.0333

    def resting(distance: float, across: float) -> float:
        """Angle theta_2 [rad] at which k_2 = l_1 cos(theta_2)."""
        root = np.sqrt(across**2 + 3 * (4 * near**2 + across**2 - distance**2))
        return float(np.arcsin((root - across) / (3 * near)))

    for millimetres, off, degrees in SLIDES:
        distance, across = 1e-3 * millimetres, 1e-3 * off
        run, _ = sliding(distance, across)
        end = resting(distance, across)
        what = f"ρ = {millimetres} mm, d = {off} mm"
        yield Check(f"{what}: θ₂ in closed form", "deg", degrees, np.degrees(end), 5.1e-7, DIGIT)
        yield Check(f"{what}: θ₂", "rad", end, run["hinge2.angle"][-1],
                    abs(resting(distance, across - SINKS) - end) + 1e-7,
                    "the contact sunk in by twice the 10 nm of a moving one; 1e-7 rad of the way "
                    "are left after 3 s")
        yield Check(f"{what}: force", "N", 10.0 * 0.006 / (near * np.cos(end)),
                    run["object/phalanx2.normal"][-1], 1e-4, "four digits")
    run, k_2 = sliding(0.080, 0.0)
    passed = int(np.argmax(k_2 > far))
    last = slice(passed - 4, passed)
    passes, sunk = np.arccos((np.array([0.080, 0.080 - SINKS])**2 - near**2 - far**2)
                             / (2 * near * far))
    yield Check("ρ = 80 mm, d = 0 mm: θ₂ as the end of the phalanx passes", "rad", passes,
                np.polyfit(k_2[last] - far, run["hinge2.angle"][last], 3)[-1], abs(sunk - passes),
                "the object nearer by twice the 10 nm that a moving contact may sink in")


F3_LENGTHS, F3_ARMS = (0.0545, 0.0465), (0.008, 0.0072)
MCGRIP_LENGTHS, MCGRIP_SIDE, MCGRIP_HEIGHTS = (0.02, 0.02, 0.02), 0.005, (0.005, 0.005, 0.00165)
"""Guides lie that far along the links on both sides of each hinge, and that high [m]."""
HELD = (*(("OpenHand F3", F3_LENGTHS, 10.0, (20.0, angle), (first, 3.096774)) for angle, first in (
    (0, -5.899970), (30, -5.070192), (60, -2.803196), (75, -1.309430), (85, -0.246225),
    (90, 0.293578))),
    *(("McGrip", MCGRIP_LENGTHS, 5.0, theta, forces) for theta, forces in (
        ((0, 0, 0), (-1.7, 0.025, 0.825)), ((30, 45, 30), (0.007563, -0.678500, 1.443936)),
        ((45, 75, 60), (2.758602, -0.423655, 1.964471)),
        ((60, 80, 70), (3.557863, -0.030810, 2.109742)))))
"""Hand, lengths [m], pull [N], pose [deg], forces at the phalanges' middles [N], computed
independently from published dimensions; a contact with a force below 0 would have to pull."""


@case("Fingers of OpenHand F3 and McGrip",
      "f = J⁻ᵀ T h, h = a cos(θ/2) + r sin(θ/2) between two guides",
      "fingers of published dimensions, without springs, every phalanx on a rod in place of a "
      "contact; h = 0.5 ms")
def test_hands_of_others() -> Iterator[Check]:
    for hand, lengths, pull, degrees, wanted in HELD:
        theta, f3 = np.radians(degrees), hand == "OpenHand F3"
        parts = links(theta, lengths, [[]] * 3)
        middles = [(length / 2, 0.0) for length in lengths]
        feet = to_world(transforms(theta, lengths), [(x, -0.5) for x, _ in middles])
        parts["joints"] += [
            {"type": "rod", "name": f"contact{i + 1}", "a": "palm", "b": f"phalanx{i + 1}",
             "on_a": tuple(feet[i]), "on_b": middle} for i, middle in enumerate(middles)]
        guides: list[tuple[str, tuple[float, float]]] = []
        for i in (2, 1, 0):
            before, at = (f"phalanx{i}", MCGRIP_LENGTHS[i - 1]) if i else ("palm", 0.0)
            guides += [(f"phalanx{i + 1}", (MCGRIP_SIDE, -MCGRIP_HEIGHTS[i])),
                       (before, (at - MCGRIP_SIDE, -MCGRIP_HEIGHTS[i]))]
        run = pulled(0.05, pull, wound(F3_ARMS) if f3 else cable(
            "tendon", *guides, ("palm", (-0.02, -MCGRIP_HEIGHTS[0]))), parts)
        arms = np.array(F3_ARMS) if f3 else (
            MCGRIP_HEIGHTS * np.cos(theta / 2) + MCGRIP_SIDE * np.sin(theta / 2))
        forces = contact_forces(contact_jacobian(theta, lengths, np.array(lengths) / 2),
                                pull * arms)
        what = f"{hand} at {', '.join(f'{angle:g}°' for angle in degrees)}"
        yield Check(f"{what}: forces in closed form", "N", wanted, forces, 5.1e-7, DIGIT)
        yield Check(f"{what}: forces", "N", forces,
                    [-run[f"contact{i + 1}.tension"][-1] for i in range(len(lengths))],
                    1e-6 * np.abs(forces).max(), "the cord's 100 kN/m and the joints give way by "
                    "less than 1e-8 m: a millionth of the largest")
    yield Check("OpenHand F3: least θ₂ that holds without friction and springs, k₂ = e", "deg",
                87.283, np.degrees(np.arccos(F3_LENGTHS[1] / 2 * 0.1 / (0.9 * F3_LENGTHS[0]))),
                5.1e-4, DIGIT)


def sdm_forces(hand: Mapping[str, float], radius: float, soft: float) -> tuple[float, float]:
    """Forces of a finger of the scene ``sdm`` with these parameters on a disc [m] [N]."""
    near, wide, pull = hand["l1"], hand["wide"], hand["pull"] / 2
    high, apart = radius - 0.006, radius + hand["rho"]
    k_1 = np.sqrt(wide**2 + high**2 - apart**2)
    k_2 = near - k_1
    fold = 2 * np.arctan(k_2 / apart)
    stands = np.pi - np.arctan2(high, wide) - np.arcsin(apart / np.hypot(wide, high))
    first, second = two_phalanx_forces(
        fold, k_1, k_2, near, pull * hand["h1"] - soft * (stands - hand["rest1"]),
        pull * hand["h2"] - hand["K2"] * (fold - hand["rest2"]))
    return float(first), float(second)


@case("SDM hand on discs, over the stiffness of its joints",
      "f₂ = (T h₂ − K₂ Δ₂) / k₂, f₁ = (T h₁ − K₁ Δ₁ − (k₂ + l₁ cos θ₂) f₂) / k₁",
      "the scene `sdm` with softer and stiffer proximal joints and other discs")
def test_sdm_range() -> Iterator[Check]:
    """A phalanx that would have to pull leaves the disc, and the other one moves."""
    hand = load_scene("sdm").parameters
    for soft in (0.02, 0.04, 0.06):
        for radius in (0.026, 0.029, 0.033):
            run = simulate(load_scene("sdm", overrides={
                "parameters.K1": soft, "parameters.r": radius}))
            first, second = sdm_forces(hand, radius, soft)
            wanted = {"proximal": first, "distal": second} if first > 0 else {"proximal": 0.0}
            yield Check(f"forces, K₁ / K₂ = {soft / hand['K2']:.2g}, disc of {1e3 * radius:g} mm",
                        "N", [[force] * 2 for force in wanted.values()],
                        [[run[f"{side}.{name}/disc.normal"][-1] for side in ("right", "left")]
                         for name in wanted], 1e-4, "four digits")
