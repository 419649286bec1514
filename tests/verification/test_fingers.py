"""Fingers: geometry of tendon, springs and chain, reactions, motion and contact forces.

Equation numbers are those of *An Underactuated Multi-finger Grasping Device*, in the corrected
form that ``sandbox.mechanics`` documents.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from sandbox.engine.simulate import simulate
from sandbox.mechanics.chain import pose, to_world, transforms
from sandbox.mechanics.grasp import disc_centre, disc_grasp
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import contact_forces, contact_jacobian, joint_torques
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import BODIES, HINGES, G, finger
from tests.support.reference import SET_A, SET_G, SET_G_TABLE, Chain, DiscRow, FingerSet

from .case import Check, case

CLOSING = "finger of Set G, straight, closing freely under 3 N for 0.06 s, h = 0.5 ms"
ROUNDING = 1e-14
"""Of lengths of some centimetres, summed over a dozen operations [m]."""
GAP = "largest measured gap of the hinges that it spans; its bound is checked with the chain"
CENTRES: Array = np.array([(length / 2, 0.0) for length in SET_G.lengths])
TENDON, SPRINGS = route(SET_G.guides, SET_G.lengths), spring_set(SET_G.before, SET_G.after)


@cache
def closing(gravity: tuple[float, float] = (0.0, 0.0)) -> Recording:
    return simulate(finger(SET_G, pull=3.0, duration=0.06, step=5e-4, stops=False,
                           gravity=gravity, run={"sample_rate": 2000.0}))


def angles(run: Recording) -> Array:
    """Joint angles [rad], shape [n, 3]."""
    return np.stack([run[f"{name}.angle"] for name in HINGES], axis=1)


def phalanges(run: Recording) -> Array:
    """Frames of the phalanges in the world, shape [n, 3, 3, 3]."""
    return pose(*(np.stack([run[f"{body}.{key}"] for body in BODIES], axis=1)
                  for key in ("x", "y", "angle")))


def far_ends(frames: Array) -> Array:
    """Ends of the phalanges [m], shape [n, 3, 2]."""
    return to_world(frames, np.stack([np.array(SET_G.lengths), np.zeros(3)], axis=1))


def gaps(run: Recording) -> Array:
    """Distance by which the hinges have drifted apart [m], shape [n, 3]."""
    frames = phalanges(run)
    before = np.concatenate([np.zeros((len(run), 1, 2)), far_ends(frames)[:, :2]], axis=1)
    return np.asarray(np.linalg.norm(frames[..., :2, 2] - before, axis=2))


@case("Tendon segments and shortening", "(8)–(19)", CLOSING)
def test_tendon() -> Iterator[Check]:
    run = closing()
    theta, gap = angles(run), gaps(run)
    palm = np.broadcast_to(np.eye(3), (len(run), 1, 3, 3))
    eyes = to_world(np.concatenate([palm, phalanges(run)], axis=1), np.array(SET_G.guides))
    segments = np.linalg.norm(np.diff(eyes, axis=1), axis=2)
    yield Check("segments", "m", TENDON.lengths(theta), segments, gap.max(axis=0) + ROUNDING, GAP)
    allowed = gap.sum(axis=1).max() + ROUNDING
    yield Check("length", "m", TENDON.lengths(theta).sum(axis=1), run["finger.tendon.length"],
                allowed, GAP)
    yield Check("shortening", "m", TENDON.shortening(theta), run["finger.tendon.shortening"],
                allowed, GAP)


@case("Elastic elements", "(20)–(30)", CLOSING)
def test_springs() -> Iterator[Check]:
    run = closing()
    theta, allowed = angles(run), gaps(run).max(axis=0) + ROUNDING
    length, force = (np.stack([run[f"finger.spring{i}.{key}"] for i in (1, 2, 3)], axis=1)
                     for key in ("length", "force"))
    k = np.array(SET_G.stiffness)
    yield Check("lengths", "m", SPRINGS.lengths(theta), length, allowed, GAP)
    yield Check("forces k Δlm", "N", k * SPRINGS.elongations(theta), force, k * allowed,
                "stiffness times the same gap")


@case("Chain of phalanges", "(31)", CLOSING)
def test_chain() -> Iterator[Check]:
    run, h = closing(), 5e-4
    yield Check("far ends of the phalanges", "m",
                far_ends(transforms(angles(run), SET_G.lengths)), far_ends(phalanges(run)),
                gaps(run).sum(axis=1).max() + ROUNDING, GAP)
    spin, growth = (np.stack([np.zeros(len(run)), *(run[f"{body}.{key}"] for body in BODIES)])
                    for key in ("omega", "alpha"))
    half = np.array([0.0, *SET_G.lengths]) / 2
    left = half[:, None] * h**3 * (np.abs(spin * growth) + np.abs(spin)**3 / 6)
    yield Check("largest gaps of the hinges", "m", 0.0, gaps(run).max(axis=0),
                1.05 * (left[:-1] + left[1:]).max(axis=1),
                "a step along the tangent, corrected by r (ω h)²/2 of the step before, leaves "
                "r ω α h³ + r (ω h)³/6 on either side; 5 % for their change within it")


def pulling(along: Array, force: Array) -> Array:
    """A force [N] along a vector."""
    return np.asarray((force / np.linalg.norm(along, axis=-1))[..., None] * along)


def loads(run: Recording, frames: Array) -> list[tuple[int, Array, Array]]:
    """Forces of tendon and springs: phalanx, point in its frame [m], force in the world [N]."""
    palm = np.broadcast_to(np.eye(3), (len(run), 1, 3, 3))
    carriers, guides = np.concatenate([palm, frames], axis=1), np.array(SET_G.guides)
    tensions = pulling(np.diff(to_world(carriers, guides), axis=1),
                       run["finger.tendon.tension"][:, None])
    pulls = np.zeros((len(run), 4, 2))
    pulls[:, :-1] += tensions
    pulls[:, 1:] -= tensions
    found = [(i, guides[i + 1], pulls[:, i + 1]) for i in range(3)]
    for i in range(3):
        near = np.add(SET_G.before[i], (0.0 if i == 0 else SET_G.lengths[i - 1], 0.0))
        far = np.array(SET_G.after[i])
        on_near = pulling(to_world(frames[:, i:i + 1], far[None])[:, 0] - to_world(
            carriers[:, i:i + 1], near[None])[:, 0], run[f"finger.spring{i + 1}.force"])
        found += [(i, far, -on_near), *([(i - 1, near, on_near)] if i else [])]
    return found


def action(force: Array, moment: Array) -> Array:
    """Φ of a force [N] and a moment about the frame's origin [N m], shape [..., 3, 3]."""
    phi = np.zeros((*moment.shape, 3, 3))
    phi[..., :2, 2], phi[..., 2, :2] = force, -force
    phi[..., 1, 0], phi[..., 0, 1] = moment, -moment
    return phi


def cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


@case("Joint reactions by recursion", "(32)–(33)",
      "the closing finger with gravity, from recorded accelerations, tension, springs and damping")
def test_reactions() -> Iterator[Check]:
    """Φ_i = -W Y + Y Wᵀ + Φ*_i + A Φ_(i+1) Aᵀ, with W less gravity, from the tip to the palm.

    Printed otherwise: (32) leaves out the change of frame by A, (33) misplaces a bracket and a T.
    """
    gravity = (2.0, -G)
    run = closing(gravity)
    m, inertia = np.array(SET_G.masses), np.array(SET_G.inertias)
    frames = phalanges(run)
    spin, growth, ax, ay = (np.stack([run[f"{body}.{key}"] for body in BODIES], axis=1)
                            for key in ("omega", "alpha", "ax", "ay"))
    needed = np.stack([ax, ay], axis=2) - gravity
    damping = np.stack([run.arrays["joint_damping"][:, run.catalogue.elements[name].index]
                        for name in HINGES], axis=1)
    couple = np.pad(damping[:, 1:], ((0, 0), (0, 1))) - damping  # joints count clockwise
    rotate = frames[..., :2, :2]
    applied, force, moment = action(np.zeros(2), couple), m[:, None] * needed, inertia * growth
    moment -= couple
    centres = to_world(frames, CENTRES)
    for i, where, pull in loads(run, frames):
        own = np.einsum("nji,nj->ni", rotate[:, i], pull)
        applied[:, i] += action(own, cross(where, own))
        force[:, i] -= pull
        lever = to_world(frames[:, i, None], where[None])[:, 0] - centres[:, i]
        moment[:, i] -= cross(lever, pull)
    w = np.zeros((*spin.shape, 3, 3))
    w[..., 0, 0] = w[..., 1, 1] = -(spin**2)
    w[..., 1, 0], w[..., 0, 1] = growth, -growth
    w[..., :2, 2] = np.einsum("nbji,nbj->nbi", rotate, needed) - np.einsum(
        "nbij,bj->nbi", w[..., :2, :2], CENTRES)
    p = np.column_stack([CENTRES, np.ones(3)])
    y = m[:, None, None] * p[:, :, None] * p[:, None, :]
    y += inertia[:, None, None] / 2 * np.diag([1.0, 1.0, 0.0])
    phi = applied - w @ y + np.swapaxes(w @ y, -1, -2)
    for i in (1, 0):
        link = np.linalg.inv(frames[:, i]) @ frames[:, i + 1]
        phi[:, i] += link @ phi[:, i + 1] @ np.swapaxes(link, -1, -2)
    reaction = -np.einsum("nbij,nbj->nbi", rotate, phi[..., :2, 2])
    beyond = np.cumsum(force[:, ::-1], axis=1)[:, ::-1]
    size, solver = np.linalg.norm(reaction, axis=2), np.stack(
        [run[f"{name}.reaction"] for name in HINGES], axis=1)
    yield Check("sizes, by the largest of each hinge, against the solver's impulse / h", "1",
                size / solver.max(axis=0), solver / solver.max(axis=0), 1e-6,
                "requirement on reactions in motion")
    yield Check("moments at the hinges, by reaction times phalanx", "1", 0.0,
                phi[..., 1, 0] / (size.max() * max(SET_G.lengths)),
                gaps(run).sum(axis=1).max() / max(SET_G.lengths),
                "an ideal hinge carries none; the solver's two halves of a hinge act as far apart "
                "as the hinge gapes")
    yield Check("d'Alembert on all that lies beyond a hinge, by the largest reaction", "1",
                beyond / size.max(), reaction / size.max(), 1e-13,
                "some hundred operations on the largest force")
    arm = centres[:, None, :] - frames[:, :, None, :2, 2]
    sums = np.triu(np.ones((3, 3))) * (cross(arm, force[:, None]) + moment[:, None])
    yield Check("its moments at the hinges, by reaction times phalanx", "1",
                -phi[..., 1, 0] / size.max() / max(SET_G.lengths),
                sums.sum(axis=2) / size.max() / max(SET_G.lengths), 1e-13, "the same")


def closing_error(numbers: FingerSet, duration: float, step: float) -> float:
    """Largest error of a joint under 3 N against the independent integration [deg]."""
    run = simulate(finger(numbers, pull=3.0, duration=duration, step=step, stops=False))
    truth = Chain(numbers).integrate(run.time, 3.0)[:, :3]
    return float(np.degrees(np.abs(angles(run) - truth).max()))


@case("A finger closing freely", "M q″ = T h − k Δlm hm − d q′ − C",
      "fingers of Set G, 0.06 s, and Set A, 0.03 s, under 3 N, against an integration of order 8 "
      "in minimal coordinates that shares no code with the engine")
def test_free_closing() -> Iterator[Check]:
    """Damped hinges take up to 0.4 of the order at these steps."""
    for numbers, duration, coarsest in ((SET_G, 0.06, 1e-3), (SET_A, 0.03, 2.5e-4)):
        errors = [closing_error(numbers, duration, coarsest / n) for n in (1, 2, 4)]
        yield Check("orders of accuracy", "1", 1.95, np.log2(np.divide(errors[:-1], errors[1:])),
                    0.35, "2, less up to 0.4 by the damped hinges; up to 0.3 more")
        if numbers is SET_G:
            yield Check("largest error of a joint at 0.5 and 0.25 ms", "deg", 0.0, errors[1:],
                        [6e-3, 1.5e-3], "requirement at 0.5 ms, and a quarter at half the step")
        else:
            yield Check("largest error of a joint at 0.0625 ms", "deg", 0.0, errors[2],
                        1.5 * (errors[1] - errors[2]) / 3,
                        "Richardson: a third of the last change, and half as much again")


def unrounded(row: DiscRow) -> DiscRow:
    """Row of the table with its exact centre: k_1 = 31 mm at theta_1 = 35 deg."""
    centre = disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    return DiscRow(row.disc_radius, (float(centre[0]), float(centre[1])), row.tension,
                   row.degrees, row.forces)


def moments_left(numbers: FingerSet, tension: ArrayLike, theta: Array) -> Array:
    """Moments of tendon and springs about the joints [N m], shape [..., 3]."""
    springs = spring_set(numbers.before, numbers.after)
    return joint_torques(
        np.asarray(tension), route(numbers.guides, numbers.lengths).arms(theta),
        numbers.stiffness, springs.elongations(theta), springs.arms(theta))


@case("Contact forces of a finger on a disc", "f = J⁻ᵀ τ",
      "finger of Set G closing on a fixed disc without friction, three rows of the table, 1.5 s")
def test_grasp_forces() -> Iterator[Check]:
    for number, row in enumerate(map(unrounded, SET_G_TABLE), start=1):
        run = simulate(finger(SET_G, pull=row.tension, duration=1.5, step=5e-4, disc=row))
        grasp = disc_grasp(row.centre, row.disc_radius, SET_G.lengths, SET_G.radii)
        forces = contact_forces(contact_jacobian(grasp.theta, SET_G.lengths, grasp.distances),
                                moments_left(SET_G, row.tension, grasp.theta))
        yield Check(f"row {number}: joint angles", "rad", grasp.theta, angles(run)[-1],
                    np.cumsum(2e-10 / grasp.distances),
                    "gaps of up to 0.1 nm on both sides of a joint, k_i from their hinges")
        yield Check(f"row {number}: forces", "N", forces,
                    [run[f"{name}.contact.normal"][-1] for name in BODIES], 1e-6 * forces,
                    "gaps of 0.1 nm change arms of 7 mm, and their differences, by less")
        yield Check(f"row {number}: closed form against the published forces", "N", row.forces,
                    forces, 0.5e-4, "half of the last digit")
        yield Check(f"row {number}: and angles", "deg", row.degrees, np.degrees(grasp.theta), 5e-4,
                    "half of the last digit")
        last = run.arrays["contact_sample"] == len(run) - 1
        assert run.arrays["contact_body"][last].tolist() == [1, 2, 3]
        yield Check(f"row {number}: contact points", "m", grasp.contacts,
                    run.arrays["contact_point"][last], 1e-10, "gaps are closed to 0.1 nm")
        yield Check(f"row {number}: normals", "1", grasp.normals,
                    run.arrays["contact_normal"][last], 1e-8, "that turns a normal by less")


def rest_angles(numbers: FingerSet, tension: float) -> Array:
    """Joint angles [rad] at which tendon and springs are in balance, or the stop; by bisection.

    Each joint depends on its own angle alone, and its closing moment falls with the angle.
    """
    low, high = np.zeros(3), np.array(numbers.limits)
    for _ in range(60):
        middle = (low + high) / 2
        closes = moments_left(numbers, tension, middle) > 0
        low, high = np.where(closes, middle, low), np.where(closes, high, middle)
    return np.asarray((low + high) / 2)


@case("Rotations under a constant pull", "T hᵢ = kᵢ Δlmᵢ hmᵢ",
      "finger of Set A under 2, 4.68 and 8 N, h = 0.2 ms")
def test_rest_angles() -> Iterator[Check]:
    for pull in (2.0, 4.68, 8.0):
        run = simulate(finger(SET_A, pull={"ramp": {"to": pull, "over": 0.2}}, duration=1.2,
                              step=2e-4))
        expected = rest_angles(SET_A, pull)
        yield Check(f"joint angles at {pull:g} N", "deg", np.degrees(expected),
                    np.degrees(angles(run)[-1]), 1e-4, "at rest but for the dampers' last motion")
        if pull == 4.68:
            short = float(route(SET_A.guides, SET_A.lengths).shortening(expected))
            yield Check("shortening at 4.68 N", "m", short, run["finger.tendon.shortening"][-1],
                        1e-8, "the same four digits")
            last = np.degrees(rest_angles(SET_A, pull + 0.005) - expected) + 0.005
            yield Check("closed form against the published angles at 4.68 N", "deg",
                        (1.49, 5.10, 22.21), np.degrees(expected), last,
                        "half of the last digits of T and of the angle")


def test_pull_below_zero_is_slack() -> None:
    run = simulate(finger(SET_G, pull=-3.0, duration=0.02, step=5e-4))
    assert np.abs(angles(run)).max() < 1e-12
    assert (run["finger.tendon.tension"] == 0).all()
