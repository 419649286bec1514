"""Published benchmarks with contacts: bouncing, rocking, toppling, rolling, friction, a cam."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json

from .case import Criterion, Digit, Problem, at, benchmark, event, exact, spelled

SETTLED = 2
"""First samples left out: a contact that begins in motion is off by half the centripetal force."""


def ground(width: float, **more: object) -> Json:
    """Fixed floor whose top is at y = 0."""
    return {"name": "floor", "motion": "fixed", **more,
            "shapes": [{"type": "box", "size": [width, 0.2], "at": [width / 4, -0.1]}]}


def first(mask: Array) -> int:
    """Index of the first true value."""
    return int(np.argmax(mask))


@benchmark("Bouncing ball",
           "A ball falls by 1 m onto a floor with e = 0.9, and bounces until it lies, after t₁ (1 "
           "+ e)/(1 − e) and endlessly many impacts.",
           "siconos-tutorials, BouncingBallTS.cpp; closed form. Below 1 cm/s, from the 58th impact "
           "on, impacts are plastic.",
           steps=(5e-4, 2e-4, 1e-4), fault={"materials.hard.restitution": 0.89})
def test_bouncing_ball() -> Problem:
    """Flights of 2 v/g with speeds v, e v, e² v, …"""
    e, speed, slow, radius = 0.9, (2 * G)**0.5, 0.01, 0.1
    t1 = speed / G
    touches = t1 + np.cumsum([0.0, *(2 * t1 * e**np.arange(1, 5))])
    impacts = float(np.log(slow / speed) / np.log(e))

    def starts(run: Recording) -> Array:
        struck = np.asarray(run["ball/floor.normal"] > 2 * G)
        return np.flatnonzero(struck & ~np.concatenate([[False], struck[:-1]]))

    def apex(i: int, run: Recording) -> float:
        a, b = starts(run)[i:i + 2]
        return float(run["ball.y"][a:b].max() - radius)

    flight, gained = 1 + (1 + e) * (2 - 1 / e), 2 * (1 + e)
    return lambda step: spelled(
        9.0, step, gravity=[0.0, -G], materials={"hard": {"friction": 0.0, "restitution": e}},
        bodies=[ground(1.0, material="hard"),
                {"name": "ball", "mass": 1.0, "at": [0.0, 1.0 + radius], "material": "hard",
                 "shapes": [{"type": "circle", "radius": radius}]}]), [
            event("heights of the first three apexes", "m",
                  [Digit(e**(2 * i + 2), partial(apex, i)) for i in range(3)],
                  (1 - e**2) * speed, "an impact acts in the step in which the gap would close, up "
                  "to v h above the floor; of that way the ball keeps the energy that it should "
                  "have lost, 1 − e²", scale=3.0, floor=G * 5e-4**2 / 8),
            event("instants of the first five touches", "s",
                  [Digit(float(t), lambda run, i=i: float(run.time[starts(run)[i]]))
                   for i, t in enumerate(touches)], 5 * flight,
                  "each is up to h early, and an impact that is σ < h early shortens its flight by "
                  "(1 + e)(2 − 1/e) σ"),
            event("instant from which on it lies", "s",
                  [Digit(t1 * (1 + e) / (1 - e), lambda run: float(
                      run.time[np.flatnonzero(np.abs(run["ball.vy"]) > 1e-9)[-1]]))],
                  (flight + gained) * impacts, "58 impacts: their instants, and the energy that "
                  "each keeps; flights below 1 cm/s are left out",
                  floor=2 * e * slow / (G * (1 - e)))]


class Block(NamedTuple):
    """Block released at rest on one corner, tilted by a share of its slenderness alpha."""

    width: float
    height: float
    tilt: float

    @property
    def alpha(self) -> float:
        """Angle at which it would stand on its corner [rad]."""
        return float(np.arctan(self.width / self.height))

    @property
    def p2(self) -> float:
        """p² = 3 g / (4 R) with half the diagonal R [1/s²]."""
        return float(1.5 * G / np.hypot(self.width, self.height))

    @property
    def kept(self) -> float:
        """Rate after an impact by that before: moments about the corner that hits."""
        return float(1 - 1.5 * np.sin(self.alpha)**2)

    def fall(self, rate: float, start: float) -> tuple[float, float, float]:
        """Instant at which it is flat [s], rate there [rad/s], and peak [rad]."""
        def flat(_: float, y: Array) -> float:
            return float(y[0])

        flat.terminal, flat.direction = True, -1  # type: ignore[attr-defined]
        found = solve_ivp(lambda _, y: [y[1], -self.p2 * np.sin(self.alpha - y[0])],
                          (0.0, 3.0), [start, rate], method="DOP853", rtol=1e-12, atol=1e-14,
                          events=[flat, lambda _, y: y[1]])
        return found.t[-1], -found.y[1, -1], max((y[0] for y in found.y_events[1]), default=start)


BLOCKS = (Block(0.2, 0.6, 0.2), Block(0.2, 0.6, 0.5), Block(0.2, 0.6, 0.8), Block(0.1, 0.4, 0.5))


@benchmark("Rocking block",
           "A block on a rough floor, tilted by a share of the angle α at which it would stand on "
           "its corner, rocks about one corner, flat, about the other. At each impact the rate "
           "falls to 1 − 1.5 sin²α of what it was.",
           "Housner (1963). Instants and peaks by an integration of order 8. Friction is 1.5 and "
           "not infinite, which is enough.",
           steps=(5e-4, 2e-4, 1e-4), quick=(1e-3, 5e-4),
           fault={"bodies[block2].shapes[0].size[0]": 0.206})
def test_rocking_block() -> Problem:
    """The rate w after an impact is off by p² sin α h for each step that it is early or late, three
    at most; by the energy the peak depends on it as w / (p² α² (1 - peak)), and the second fall
    follows cosh(p t) = 1/(1 - peak).
    """
    bodies = [ground(10.0, material="rough")]
    falls, rates, peaks, again, shares, later = [], [], [], [], [], []
    for i, b in enumerate(BLOCKS):
        half, left = np.hypot(b.width, b.height) / 2, b.alpha * (1 - b.tilt)
        bodies.append({
            "name": f"block{i + 1}", "mass": 1.0, "angle": -b.alpha * b.tilt,
            "at": [2.0 * i - half * np.sin(left), half * np.cos(left)], "material": "rough",
            "shapes": [{"type": "box", "size": [b.width, b.height]}]})
        flat, rate, _ = b.fall(0.0, b.tilt * b.alpha)
        second, _, peak = b.fall(b.kept * rate, 1e-15)

        def course(run: Recording, i: int = i, until: float = flat + second + 0.02,
                   ) -> tuple[Array, int, int, int]:
            """Tilt, and the samples before it is flat, of its peak, before it is flat again."""
            tilt = -run[f"block{i + 1}.angle"]
            one = first(tilt <= 0) - 1
            top = one + int(np.argmin(tilt[one:first(run.time > until)]))
            return tilt, one, top, top + first(tilt[top:] >= 0) - 1

        def crossing(which: int, run: Recording, course: Callable[..., tuple[Array, int, int, int]]
                     = course) -> float:
            found = course(run)
            tilt, k = found[0], found[which]
            share = tilt[k] / (tilt[k] - tilt[k + 1])
            return float(run.time[k] + share * (run.time[k + 1] - run.time[k]))

        falls.append(Digit(flat, partial(crossing, 1)))
        again.append(Digit(flat + second, partial(crossing, 3)))
        rates.append(Digit(rate, lambda run, i=i, course=course: float(
            run[f"block{i + 1}.omega"][:course(run)[1] + 1].max())))
        peaks.append(Digit(peak / b.alpha, lambda run, b=b, course=course: float(
            -course(run)[0][course(run)[2]] / b.alpha)))
        rest = 1 - peak / b.alpha
        shares.append(3 * b.kept * rate / (b.alpha * rest))
        later.append(1 + 2 * shares[-1] / (rest * (b.p2 * (1 - rest**2))**0.5))
    landing = "the impact falls somewhere in its step, or is shared by two"
    return lambda step: spelled(
        1.0, step, gravity=[0.0, -G], bodies=bodies,
        materials={"rough": {"friction": 1.5, "restitution": 0.0}}), [
            event("instants of the first fall", "s", falls, 1.0, "an instant is known to its step"),
            event("rates before the impact", "rad/s", rates,
                  2 * max(b.p2 * b.alpha for b in BLOCKS),
                  "of the last sample before it, up to two steps of p² α early"),
            event("peaks after it", "α", peaks, max(shares), f"{landing}; gravity changes the rate "
                  "in three steps"),
            event("instants of the second fall", "s", again, max(later),
                  f"the first fall's, and the peak's effect on it; {landing}")]


@benchmark("Pinch that must not creep",
           "Two pads press 12 N each on a disc of 45 g, r = 4 mm, with μ = 0.7: it has to stay "
           "where it is. Soft contact models let it sink by 50 to 2300 μm/s. A second disc is "
           "pressed 1 % too weakly and has to slide, with 0.01 g.",
           "MuJoCo, issue 3328.",
           steps=(2e-3, 1e-3, 5e-4), fault={"materials.rubber.friction": 0.703})
def test_pinch() -> Problem:
    m, radius, mu = 0.045, 0.004, 0.7
    bodies: list[Json] = [{"name": "frame", "motion": "fixed"}]
    joints, drives = [], []
    for name, x, push in (("held", 0.0, 12.0), ("slides", 0.5, 0.99 * m * G / (2 * mu))):
        bodies.append({"name": name, "mass": m, "at": [x, 0.0], "material": "rubber",
                       "shapes": [{"type": "circle", "radius": radius}]})
        for side, way in (("left", 1.0), ("right", -1.0)):
            pad = f"{name}_{side}"
            bodies.append({"name": pad, "mass": 0.02, "inertia": 1e-5, "material": "rubber",
                           "at": [x - way * (radius + 0.005), 0.0],
                           "shapes": [{"type": "box", "size": [0.01, 0.5]}]})
            joints.append({"type": "slot", "name": f"{pad}_guide", "a": "frame", "b": pad,
                           "start": [x - 0.1, 0.0], "end": [x + 0.1, 0.0], "turns": False})
            drives.append({"type": "force", "name": f"{pad}_push", "body": pad,
                           "direction": [way, 0.0], "value": push})
    return lambda step: spelled(
        2.0, step, gravity=[0.0, -G], sample_rate=500.0, bodies=bodies, joints=joints,
        drives=drives, materials={"rubber": {"friction": mu}}), [
            exact("height after 2 s", "m", [at("held.y", 2.0, 0.0)], 1e-9,
                  "1 nm: a hundredth of any soft contact's creep in 2 ms"),
            exact("friction at rest", "N",
                  [Digit(m * G / 2, lambda run, side=side: abs(float(
                      run[f"held/held_{side}.tangential"][-1]))) for side in ("left", "right")],
                  1e-9, "half the weight, nine digits"),
            exact("way of the one that slides", "m",
                  [at("slides.y", 0.5, -0.01 * G * 0.5**2 / 2)], G * 2e-3**2 / 8,
                  "a constant force: exact; it begins within g h²/8 = 5 μm of that")]


def first_slip(forces: Callable[[float], tuple[float, float]], friction: float) -> float:
    """Least angle [deg] at which |F| = μ N."""
    def left(degrees: float) -> float:
        normal, tangential = forces(np.radians(degrees))
        return friction * normal - abs(tangential)

    angles = np.linspace(1.0, 70.0, 6901)
    k = next(i for i, angle in enumerate(angles) if left(angle) < 0)
    return float(brentq(left, angles[k - 1], angles[k], xtol=1e-12))


@benchmark("Toppling rod",
           "A thin uniform rod falls over from upright. While its tip sticks the floor carries N = "
           "m g (3 cos θ − 1)²/4 and F = ¾ m g sin θ (3 cos θ − 2); it slips where |F| exceeds μ "
           "N, backward or forward.",
           "Textbook; closed form. It begins at 0.1 rad, with the rate that it has there; the "
           "first two samples are left out. The tip is a corner of 1 : 50. μ = 0.37 is left out: "
           "with F/N ≤ 0.370579 its place depends on 2 · 10⁻³ of F/N.",
           steps=(1e-3, 5e-4, 2.5e-4), fault={"bodies[rod6].inertia": 1.02 * 0.2 * 0.25 / 12})
def test_toppling_rod() -> Problem:
    length, m, start = 0.5, 0.2, 0.1
    frictions = (0.1, 0.2, 0.3, 0.4, 0.5, 0.8)

    def rate(angle: float) -> float:
        return float(np.sqrt(3 * G / length * (1 - np.cos(angle))))

    def forces(angle: float) -> tuple[float, float]:
        return ((3 * np.cos(angle) - 1)**2 / 4, 0.75 * np.sin(angle) * (3 * np.cos(angle) - 2))

    half, turn = length / 2, rate(start)
    rods: list[Json] = [{
        "name": f"rod{i + 1}", "mass": m, "inertia": m * length**2 / 12, "centre": [0.0, half],
        "at": [2.0 * i, 0.0], "angle": -start, "angular_velocity": -turn,
        "velocity": [turn * half * np.cos(start), -turn * half * np.sin(start)],
        "shapes": [{"type": "polygon", "points": [[0.0, 0.0], [1e-3, 0.1], [-1e-3, 0.1]]}],
    } for i in range(len(frictions))]

    def contact(run: Recording, i: int) -> tuple[Array, Array, Array]:
        """Angle from upright [rad], N and F in weights, F along the fall."""
        pair = f"rod{i}/floor"
        return (-run[f"rod{i}.angle"], run[f"{pair}.normal"] / (m * G),
                -run[f"{pair}.tangential"] / (m * G))

    def error(which: int, run: Recording) -> float:
        found = [values[SETTLED:] for values in contact(run, len(frictions))]
        upright = found[0] < np.radians(45.0)
        truth = forces(found[0][upright])[which]  # type: ignore[arg-type]
        return float(np.abs(found[which + 1][upright] - truth).max())

    def steepest(run: Recording) -> float:
        angle, normal, tangential = contact(run, len(frictions))
        return float((tangential / normal)[angle < np.radians(45.0)].max())

    def slips(i: int, mu: float, run: Recording) -> float:
        angle, normal, tangential = contact(run, i)
        k = first(np.abs(tangential) >= mu * normal * (1 - 1e-9))
        return float(np.degrees(angle[k - 1] + angle[k]) / 2)

    def changes_sign(run: Recording) -> float:
        angle, _, tangential = contact(run, len(frictions))
        k = first(tangential < 0)
        share = tangential[k - 1] / (tangential[k - 1] - tangential[k])
        return float(np.degrees(angle[k - 1] + share * (angle[k] - angle[k - 1])))

    onset = {mu: first_slip(forces, mu) for mu in frictions}
    fast = rate(float(np.radians(max(onset.values()))))
    top = -minimize_scalar(lambda a: -forces(a)[1] / forces(a)[0], (0.5, 0.6, 0.7)).fun
    return lambda step: spelled(
        0.55, step, gravity=[0.0, -G], bodies=[ground(20.0), *rods],
        contacts=[{"between": [f"rod{i + 1}", "floor"], "friction": mu}
                  for i, mu in enumerate(frictions)]), [
            Criterion("forces of the floor up to 45°", "weights",
                      [Digit(0.0, partial(error, 0)), Digit(0.0, partial(error, 1)),
                       Digit(float(top), steepest)], "(ω h)²", 1.0, fast),
            event("angles at which slip begins", "deg",
                  [Digit(angle, partial(slips, i + 1, mu))
                   for i, (mu, angle) in enumerate(onset.items())], fast,
                  "the step in which it begins, ω h; and as much by the error of F/N",
                  scale=np.degrees(2.0)),
            Criterion("angle at which friction changes sign", "deg",
                      [Digit(float(np.degrees(np.arccos(2 / 3))), changes_sign)],
                      "(ω h)²; and between two samples", np.degrees(1.0), fast, falls=False)]


class Rolling(NamedTuple):
    """Disc of inertia k m r² on a hill, and where it leaves or slips [deg]."""

    name: str
    k: float
    friction: float
    angle: float

    @property
    def share(self) -> float:
        """Of the inertia that rolls; 0 without friction."""
        return self.k if self.friction else 0.0

    def rate(self, angle: float) -> float:
        """Of the line of centres of 250 mm, at an angle from the top [rad/s]."""
        return float(np.sqrt(2 * G * (1 - np.cos(angle)) / (0.25 * (1 + self.share))))


@benchmark("Disc rolling off a disc",
           "A disc on top of a fixed one begins to roll down, N = m g (cos θ − 2 (1 − cos θ)/(1 + "
           "k)), and leaves at cos θ = 4/7; a hoop at 1/2, a smooth disc at 2/3. With less "
           "friction it slips before.",
           "Textbook; closed form. It begins at 0.1 rad, as fast as it is there; the first two "
           "samples are left out.",
           steps=(1e-3, 5e-4, 2.5e-4), fault={"bodies[disc].inertia": 0.505 * 0.05**2})
def test_rolling_disc() -> Problem:
    arm, radius, start = 0.25, 0.05, 0.1
    leaves = [Rolling(name, k, friction, float(np.degrees(np.arccos(
        2 / (3 + (k if friction else 0.0)))))) for name, k, friction in (
            ("disc", 0.5, 1e3), ("hoop", 1.0, 1e3), ("smooth", 0.5, 0.0))]
    slips = [Rolling(f"slips{i + 1}", 0.5, mu, first_slip(
        lambda a: ((7 * np.cos(a) - 4) / 3, np.sin(a) / 3), mu))
        for i, mu in enumerate((0.1, 0.3, 0.5, 1.0))]
    bodies, rules = [], []
    for i, one in enumerate((*leaves, *slips)):
        u, speed = one.rate(start), one.rate(start) * arm
        bodies += [
            {"name": f"{one.name}_hill", "motion": "fixed", "at": [float(i), 0.0],
             "shapes": [{"type": "circle", "radius": arm - radius}]},
            {"name": one.name, "mass": 1.0, "inertia": one.k * radius**2,
             "at": [i + arm * np.sin(start), arm * np.cos(start)],
             "velocity": [speed * np.cos(start), -speed * np.sin(start)],
             "angular_velocity": -u * arm / radius if one.friction else 0.0,
             "shapes": [{"type": "circle", "radius": radius}]}]
        rules.append({"between": [one.name, f"{one.name}_hill"], "friction": one.friction})

    def contact(run: Recording, one: Rolling) -> tuple[Array, Array, Array]:
        """Angle from the top [rad], N and |F| in weights."""
        pair, place = f"{one.name}/{one.name}_hill", (*leaves, *slips).index(one)
        return (np.arctan2(run[f"{one.name}.x"] - place, run[f"{one.name}.y"]),
                run[f"{pair}.normal"] / G, np.abs(run[f"{pair}.tangential"]) / G)

    def happens(one: Rolling, run: Recording) -> float:
        angle, normal, tangential = contact(run, one)
        k = first(normal <= 0 if one in leaves else
                  tangential >= one.friction * normal * (1 - 1e-9))
        return float(np.degrees(angle[k - 1] + angle[k]) / 2)

    def error(one: Rolling, run: Recording) -> float:
        angle, normal, _ = contact(run, one)
        a = angle[SETTLED:first(angle > np.radians(47.0))]
        truth = np.cos(a) - 2 * (1 - np.cos(a)) / (1 + one.share)
        return float(np.abs(normal[SETTLED:SETTLED + len(a)] - truth).max())

    fast = max(one.rate(float(np.radians(one.angle))) for one in leaves)
    why = "the step in which it happens: θ′ h"
    return lambda step: spelled(0.7, step, gravity=[0.0, -G], bodies=bodies, contacts=rules), [
        Criterion("errors of N up to 47°", "weights",
                  [Digit(0.0, partial(error, one)) for one in leaves],
                  "N falls by (1 + 2/(1 + k)) m g for 1 − cos θ, 3 at most; rate √(g/(R + r)), at "
                  "which it leaves the top", 3.0, (G / arm)**0.5),
        event("angles at which they leave", "deg",
              [Digit(one.angle, partial(happens, one)) for one in leaves], fast, why,
              scale=np.degrees(1.0)),
        event("angles at which slip begins", "deg",
              [Digit(one.angle, partial(happens, one)) for one in slips], fast, why,
              scale=np.degrees(1.0))]
