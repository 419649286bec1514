"""Fingers of other authors' hands: where they slide to, with what they press, what they hold.

A contact can only push. To measure what a pose asks of every contact, also where it asks one to
pull, the phalanges stand on rigid rods along the contacts' normals in place of an object.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics.chain import inverse, pose, to_world, transforms
from sandbox.mechanics.statics import contact_forces, contact_jacobian
from sandbox.mechanics.transmission import equilibrium_distance, two_phalanx_forces
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.study.plain_mechanisms import cord, fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

DEG = float(np.radians(1))
EYE = (-0.03, 0.03)
"""Where a cord with constant arms comes out of the palm, from the first hinge [m]."""
OBJECT, RADIUS = 0.008, 0.005
"""Radius of the object that a phalanx slides on, and half the phalanx's thickness [m]."""
SINKS = 2e-8
"""Left to a contact that moves, as in the grasp states [m]."""
SLIDE_LENGTHS, SLIDE_ARMS, SLIDE_PULL = (0.050, 0.0333), (0.012, 0.006), 10.0
"""Of the finger that slides [m], [m], [N]."""
BEGIN = (40 * DEG, 20 * DEG)
"""The pose in which it is let go."""
SLIDES = ((60, 0, 67.482175), (65, 0, 61.341819), (70, 0, 55.550098), (75, 0, 49.797034),
          (60, 18, 56.556353), (65, 18, 52.159842))
"""Of the object's centre from hinge 1 and from the phalanx's axis [mm], and theta_2 [deg] in which
it ends, worked out apart from this program."""
ROD, HOLD = 0.5, 1e-6
"""Length of the rods [m]; share of the largest force that they leave open."""


def _links(theta: Sequence[float], lengths: Sequence[float],
           shapes: Sequence[dict[str, Any]] | None = None) -> dict[str, Any]:
    """Phalanges on hinges from the palm at the origin, closing clockwise."""
    frames, angles = transforms(theta, lengths), -np.cumsum(theta)
    bodies: list[Any] = [fixed("palm")]
    joints = []
    for i, length in enumerate(lengths):
        bodies.append({
            "name": f"phalanx{i + 1}", "at": tuple(frames[i, :2, 2]), "angle": angles[i],
            "mass": 0.01, "centre": (length / 2, 0.0), "inertia": 0.01 * length**2 / 12,
            "material": "smooth", "shapes": [shapes[i]] if shapes else []})
        joints.append({
            "type": "pin", "name": f"hinge{i + 1}", "a": "palm" if i == 0 else f"phalanx{i}",
            "b": f"phalanx{i + 1}", "on_b": (0.0, 0.0), "positive": "clockwise",
            "damping": 2e-3})
    return {"bodies": bodies, "joints": joints}


def _wound(arms: Sequence[float]) -> dict[str, Any]:
    """A cord round wheels on two hinges: its arms are the wheels' radii in every pose."""
    return cord("tendon", ("phalanx2", (0.0, 0.0), arms[1], "right"),
                ("palm", (0.0, 0.0), arms[0], "right"), ("palm", EYE))


def sliding(distance: float, across: float) -> Mechanism:
    """A finger whose distal phalanx alone touches a fixed disc, ``across`` its axis [m].

    The phalanx's skin lies so that the disc's centre is by that much off the axis: 0 is the
    thin finger on a point of the closed form.
    """
    (first, second), (near, far) = BEGIN, SLIDE_LENGTHS
    k_2 = np.sqrt(distance**2 - (near * np.sin(second) - across)**2) - near * np.cos(second)
    skin = OBJECT + RADIUS - across
    shapes: list[dict[str, Any]] = [
        {"type": "circle", "radius": RADIUS},
        {"type": "capsule", "start": (0.0, skin), "end": (far + 0.005, skin), "radius": RADIUS}]
    parts = _links((first, second), SLIDE_LENGTHS, shapes)
    centre = to_world(transforms(BEGIN, SLIDE_LENGTHS), [(0.0, 0.0), (k_2, -across)])[1]
    parts["bodies"].append(fixed("object", at=tuple(centre), material="smooth",
                                 shapes=[{"type": "circle", "radius": OBJECT}]))
    return mechanism(
        duration=3.0, **parts, tendons=[_wound(SLIDE_ARMS)],
        drives=[{"type": "pull", "name": "pull", "tendon": "tendon", "value": SLIDE_PULL}],
        materials={"smooth": {"friction": 0.0}},
        contacts=[{"between": ("*", "*"), "collide": False},
                  {"between": ("object", "phalanx2"), "collide": True}])


def resting(distance: float, across: float) -> float:
    """theta_2 [rad] at which k_2 = l_1 cos(theta_2), X = 1/2, that far from hinge 1 [m]."""
    near = SLIDE_LENGTHS[0]
    root = np.sqrt(across**2 + 3 * (4 * near**2 + across**2 - distance**2))
    return float(np.arcsin((root - across) / (3 * near)))


def _along(run: Recording) -> Array:
    """k_2 of every sample [m]."""
    elements, poses = run.catalogue.elements, run.arrays["body_pose"]
    at = poses[:, elements["phalanx2"].index]
    frames = inverse(pose(at[:, 0], at[:, 1], at[:, 2]))
    centre = poses[0, elements["object"].index, :2]
    return np.asarray(frames[:, 0, :2] @ centre + frames[:, 0, 2])


def _columns(points: ArrayLike) -> tuple[Array, Array]:
    """X and y of points, shape [n, 2]."""
    x, y = np.transpose(points)
    return np.asarray(x), np.asarray(y)


def _ejection() -> Findings:
    checks: list[Check] = []
    ways: dict[int, list[Array]] = {0: [], 18: []}
    rests: list[tuple[float, float]] = []
    for millimetres, off, degrees in SLIDES:
        distance, across = 1e-3 * millimetres, 1e-3 * off
        run, end = simulate(sliding(distance, across)), resting(distance, across)
        what = f"ρ = {millimetres} mm, d = {off} mm"
        sunk = abs(resting(distance, across - SINKS) - end)
        checks += [
            Check(f"{what}: θ₂ in closed form", "deg", degrees, end / DEG, 5.1e-7,
                  "half of the last digit"),
            Check(f"{what}: θ₂", "rad", end, float(run["hinge2.angle"][-1]), sunk + 1e-7,
                  "the contact sunk by twice the 10 nm that a moving one may have; 1e-7 rad of "
                  "the way are left after 3 s"),
            Check(f"{what}: force", "N",
                  SLIDE_PULL * SLIDE_ARMS[1] / (SLIDE_LENGTHS[0] * np.cos(end)),
                  float(run["object/phalanx2.normal"][-1]), 1e-4, "four digits")]
        rests.append((1e3 * SLIDE_LENGTHS[0] * np.cos(end), end / DEG))
        ways[off] += [np.column_stack([1e3 * _along(run), run["hinge2.angle"] / DEG]),
                      np.full((1, 2), np.nan)]
    found, gone = _ejected()
    checks.append(found)
    drawn = [Curve(f"d = {off} mm", *_columns(np.concatenate(way))) for off, way in ways.items()]
    angles = np.linspace(20, 70, 51) * DEG
    edge = 1e3 * equilibrium_distance(angles, SLIDE_LENGTHS[0], 0.5)
    return Findings(checks, [Panel("Slides until f₁ = 0, or off the tip", "k₂ [mm]", "θ₂ [deg]", [
        Curve("equilibrium curve", edge, angles / DEG, "dashed"), *drawn,
        Curve("ejected", *_columns(gone)),
        Curve("rest in closed form", *_columns(rests), kind="points")])])


def _ejected() -> tuple[Check, Array]:
    """At 80 mm there is no rest on the phalanx: by when its end passes; the way [mm, deg]."""
    near, far, distance = *SLIDE_LENGTHS, 0.080
    run = simulate(sliding(distance, 0.0))
    k_2 = _along(run)
    passed = int(np.argmax(k_2 > far))
    on, last = slice(0, passed + 1), slice(passed - 4, passed)
    cubic = np.polyfit(k_2[last] - far, run["hinge2.angle"][last], 3)
    passes, sunk = np.arccos((np.array([distance, distance - SINKS])**2 - near**2 - far**2)
                             / (2 * near * far))
    check = Check("ρ = 80 mm, d = 0 mm: θ₂ as the end of the phalanx passes", "rad", float(passes),
                  float(cubic[-1]), abs(float(sunk - passes)),
                  "the object nearer by twice the 10 nm that a moving contact may have sunk in")
    return check, np.column_stack([1e3 * k_2[on], run["hinge2.angle"][on] / DEG])


class Held(NamedTuple):
    """A finger in a pose, every phalanx on a rod, and what is published of its forces."""

    hand: str
    lengths: tuple[float, ...]
    pull: float
    theta: tuple[float, ...]
    """[deg]"""
    wanted: tuple[float, ...]
    """f of the contacts at the phalanges' middles [N]; below 0 the contact would have to pull."""


F3, MCGRIP = "OpenHand F3", "McGrip"
F3_LENGTHS, F3_ARMS = (0.0545, 0.0465), (0.008, 0.0072)
MCGRIP_LENGTHS, MCGRIP_SIDE, MCGRIP_HEIGHTS = (0.02, 0.02, 0.02), 0.005, (0.005, 0.005, 0.00165)
"""Guides lie that far along the links on both sides of each hinge, and that high [m]."""
TABLE = (
    *(Held(F3, F3_LENGTHS, 10.0, (20.0, angle), (first, 3.096774)) for angle, first in (
        (0, -5.899970), (30, -5.070192), (60, -2.803196), (75, -1.309430), (85, -0.246225),
        (90, 0.293578))),
    Held(MCGRIP, MCGRIP_LENGTHS, 5.0, (0, 0, 0), (-1.7, 0.025, 0.825)),
    Held(MCGRIP, MCGRIP_LENGTHS, 5.0, (30, 45, 30), (0.007563, -0.678500, 1.443936)),
    Held(MCGRIP, MCGRIP_LENGTHS, 5.0, (45, 75, 60), (2.758602, -0.423655, 1.964471)),
    Held(MCGRIP, MCGRIP_LENGTHS, 5.0, (60, 80, 70), (3.557863, -0.030810, 2.109742)))
"""Of the two hands' published dimensions; the forces worked out apart from this program."""


def _arms(held: Held) -> Array:
    """Of the tendon [m]: constant, or a cos(theta / 2) + r sin(theta / 2) between two guides."""
    if held.hand == F3:
        return np.array(F3_ARMS)
    half = np.radians(held.theta) / 2
    return np.asarray(MCGRIP_HEIGHTS * np.cos(half) + MCGRIP_SIDE * np.sin(half))


def _routed() -> dict[str, Any]:
    """The cord of the three links, from the tip to the palm."""
    guides: list[tuple[str, tuple[float, float]]] = []
    for i in (2, 1, 0):
        before, at = (f"phalanx{i}", MCGRIP_LENGTHS[i - 1]) if i else ("palm", 0.0)
        guides += [(f"phalanx{i + 1}", (MCGRIP_SIDE, -MCGRIP_HEIGHTS[i])),
                   (before, (at - MCGRIP_SIDE, -MCGRIP_HEIGHTS[i]))]
    return cord("tendon", *guides, ("palm", (-0.02, -MCGRIP_HEIGHTS[0])))


def standing(held: Held) -> Mechanism:
    """The finger in its pose, its phalanges' middles held by rods along their normals."""
    theta = np.radians(held.theta)
    parts = _links(tuple(theta), held.lengths)
    middles = [(length / 2, 0.0) for length in held.lengths]
    feet = to_world(transforms(theta, held.lengths), [(x, -ROD) for x, _ in middles])
    parts["joints"] += [
        {"type": "rod", "name": f"contact{i + 1}", "a": "palm", "b": f"phalanx{i + 1}",
         "on_a": tuple(foot), "on_b": middle}
        for i, (foot, middle) in enumerate(zip(feet, middles, strict=True))]
    return mechanism(
        duration=0.05, **parts, tendons=[_wound(F3_ARMS) if held.hand == F3 else _routed()],
        drives=[{"type": "pull", "name": "pull", "tendon": "tendon", "value": held.pull}],
        materials={"smooth": {"friction": 0.0}})


def _held() -> Findings:
    checks: list[Check] = []
    points: list[tuple[float, float]] = []
    for held in TABLE:
        run = simulate(standing(held))
        theta = np.radians(held.theta)
        J = contact_jacobian(theta, held.lengths, np.array(held.lengths) / 2)
        forces = contact_forces(J, held.pull * _arms(held))
        size = float(np.abs(forces).max())
        what = f"{held.hand} at {', '.join(f'{angle:g}°' for angle in held.theta)}"
        for i, (wanted, force) in enumerate(zip(held.wanted, forces, strict=True)):
            found = -float(run[f"contact{i + 1}.tension"][-1])
            checks += [
                Check(f"{what}: f{i + 1} in closed form", "N", wanted, float(force), 5.1e-7,
                      "half of the last digit"),
                Check(f"{what}: f{i + 1}", "N", float(force), found, HOLD * size,
                      "a millionth of the largest: the cord's 100 kN/m and the joints give way "
                      "by less than 1e-8 m")]
        if held.hand == F3:
            points.append((held.theta[1], -float(run["contact1.tension"][-1])))
    least = float(np.degrees(np.arccos(F3_LENGTHS[1] / 2 * 0.1 / (0.9 * F3_LENGTHS[0]))))
    checks.append(Check("OpenHand F3: least θ₂ that holds without friction and springs", "deg",
                        87.283, least, 5.1e-4, "half of the last digit; k₂ = e"))
    angles = np.linspace(0, 100, 101) * DEG
    pulls = 10.0 * np.array(F3_ARMS)
    curve = two_phalanx_forces(angles, F3_LENGTHS[0] / 2, F3_LENGTHS[1] / 2, F3_LENGTHS[0], *pulls)
    return Findings(checks, [Panel("OpenHand F3 without springs: proximal force", "θ₂ [deg]",
                                   "f₁ [N]", [
        Curve("closed form", angles / DEG, curve.proximal),
        Curve("engine", *_columns(points), kind="points")])])


SDM_SOFT = (0.02, 0.04, 0.06)
"""Stiffnesses of the proximal joint that are tried [N m/rad]."""
SDM_RADII = (0.026, 0.029, 0.033)
"""Of discs that are held in the engine [m]."""


def sdm_forces(hand: Mapping[str, float], radius: ArrayLike, soft: float) -> Array:
    """f_1, f_2 [N] of each finger on discs [m], shape [2, ...]; ``hand``: parameters of ``sdm``."""
    near, wide, pull = hand["l1"], hand["wide"], hand["pull"] / 2
    high, apart = np.subtract(radius, 0.006), np.add(radius, hand["rho"])
    k_1 = np.sqrt(wide**2 + high**2 - apart**2)
    k_2 = near - k_1
    fold = 2 * np.arctan(k_2 / apart)
    stands = np.pi - np.arctan2(high, wide) - np.arcsin(apart / np.hypot(wide, high))
    tau = (pull * hand["h1"] - soft * (stands - hand["rest1"]),
           pull * hand["h2"] - hand["K2"] * (fold - hand["rest2"]))
    return np.asarray(np.stack(two_phalanx_forces(fold, k_1, k_2, near, *tau)))


def _sdm() -> Findings:
    checks: list[Check] = []
    curves: list[Curve] = []
    radii, hand = np.linspace(0.022, 0.037, 151), load_scene("sdm").parameters
    for soft in SDM_SOFT:
        label = f"K₁ / K₂ = {soft / hand['K2']:.2g}"
        curves.append(Curve(label, 1e3 * radii, sdm_forces(hand, radii, soft).min(axis=0)))
        least = []
        for radius in SDM_RADII:
            run = simulate(load_scene("sdm", overrides={
                "parameters.K1": soft, "parameters.r": radius}))
            first, second = sdm_forces(hand, radius, soft)
            # one that would have to pull lets go, and the other finds another place
            wanted = {"proximal": first, "distal": second} if first > 0 else {"proximal": 0.0}
            checks += [Check(
                f"{label}, disc of {1e3 * radius:g} mm: {side} {name} phalanx", "N", float(force),
                float(run[f"{side}.{name}/disc.normal"][-1]), 1e-4, "four digits")
                for name, force in wanted.items() for side in ("right", "left")]
            least.append(min(run[f"right.{name}/disc.normal"][-1] for name in wanted))
        curves.append(Curve(f"{label}, engine", 1e3 * np.array(SDM_RADII), np.array(least),
                            "points"))
    return Findings(checks, [Panel("Smaller force of a finger's two phalanges", "disc [mm]",
                                   "f [N]", curves)])


CASES = (
    Case("ejection", "Slides that end on the equilibrium curve, or off the tip",
         "k₂ = l₁ cos θ₂ (X = 1/2), ρ² = (k₂ + l₁ cos θ₂)² + (l₁ sin θ₂ − d)²",
         "two phalanges of 50 and 33.3 mm, arms of 12 and 6 mm, 10 N, let go at θ₂ = 20° with the "
         "distal phalanx alone on a smooth fixed object; 3 s, h = 0.5 ms",
         "the angle and force of rest, or the angle at which the tip passes, with the closed form",
         _ejection),
    Case("hands_of_others", "Fingers of OpenHand F3 and McGrip",
         "f = J⁻ᵀ T h, h = a cos(θ/2) + r sin(θ/2) between two guides",
         "fingers of published dimensions, without springs, every phalanx on a rod in place of a "
         "contact; h = 0.5 ms",
         "the force of every rod with the closed form, where a contact would have to pull, too",
         _held),
    Case("sdm_range", "Discs that the SDM hand's phalanges press, over its joints' stiffness",
         "f₂ = (T h₂ − K₂ Δ₂) / k₂, f₁ = (T h₁ − K₁ Δ₁ − (k₂ + l₁ cos θ₂) f₂) / k₁",
         "the scene `sdm` with softer and stiffer proximal joints and other discs; there are no "
         "published digits to hold it against",
         "forces of all phalanges with the closed form", _sdm),
)
