"""The finger of Set G: tendon led by a schedule, closing freely, round a disc; four of them.

Statics and motion that these are held against are closed forms and an integration in the fewest
coordinates (``sandbox.mechanics``, ``sandbox.study.independent``): nothing of the engine.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from sandbox.mechanics.grasp import disc_centre
from sandbox.recording.recording import Recording
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.study import independent
from sandbox.study.plain_mechanisms import BODIES, HINGES, finger
from sandbox.study.reference_fingers import SET_G, SET_G_TABLE, DiscRow
from sandbox.verification.benchmarks.pieces import point
from tests.hard.measures import late
from tests.hard.trial import AtMost, Measure, Order, Trial
from tests.hard.trials.cords import STIFF
from tests.hard.truth.fingers import rest

SHORTENING = 0.01


def angles(run: Recording) -> np.ndarray:
    """Of the hinges [deg], shape [n, 3]."""
    return np.degrees(np.stack([run[f"{hinge}.angle"] for hinge in HINGES], axis=1))


def led(step: float) -> Mechanism:
    """The tendon tied to a body that moves away by 10 mm in 0.5 s."""
    plain = finger(SET_G, pull=0.0, duration=3.0, step=step).model_dump(by_alias=True)
    palm = SET_G.guides[0]
    plain["drives"] = []
    slide = {
        "name": "slide", "motion": "scheduled", "at": (palm[0] - 0.05, palm[1]),
        "path": {"x": {"ramp": {"from": palm[0] - 0.05, "to": palm[0] - 0.05 - SHORTENING,
                                "over": 0.5}}}}
    cord = plain["tendons"][0]
    plain["bodies"] = [*plain["bodies"], slide]
    plain["tendons"] = [{**cord, "guides": [*cord["guides"], {"body": "slide"}]}]
    return Mechanism.model_validate(plain)


def _led() -> Trial:
    truth, turned = rest(SET_G.guides, SET_G.lengths, SET_G.before, SET_G.after, SET_G.stiffness,
                         SHORTENING, STIFF)

    def off(run: Recording) -> float:
        return float(np.abs(run["finger.tendon.tension"][late(run, 0.2)] / truth - 1).max())

    def jump(run: Recording) -> float:
        return float(np.abs(np.diff(run["finger.tendon.tension"][late(run, 1.0)])).max())

    def pose(run: Recording) -> float:
        return float(np.abs(angles(run)[-1] - np.degrees(turned)).max())

    targets = [target for step in (1e-3, 2.5e-4) for target in (
        AtMost("tension error", step, 1e-3, "least energy of the springs; the slowest hinge has "
               "settled to 1e-4"),
        AtMost("jump of tension", step, 1e-6, "from one sample to the next, once at rest"))]
    return Trial(
        "led_finger", "a finger whose tendon a schedule draws in by 10 mm in 0.5 s, 3 s", led,
        (Measure("tension error", "", off), Measure("jump of tension", "N", jump),
         Measure("pose error", "deg", pose)),
        (*targets, AtMost("pose error", 2.5e-4, 0.01, "the same equilibrium")))


DAMPED_ORDER = (
    "2 less what the fastest damped motion, 2850/s, takes of it by its start at this step: 0.2; "
    "from 1 to 0.5 ms 0.5 (closed form in tests/verification/test_engine_finger.py)")


def _closing() -> Trial:
    def of(run: Recording) -> float:
        truth = independent.integrate(SET_G, run.time, pull=3.0)
        return float(np.abs(angles(run) - np.degrees(truth.angle)).max())

    return Trial(
        "closing", "a finger closing freely under 3 N, 0.06 s",
        lambda step: finger(SET_G, pull=3.0, duration=0.06, step=step, stops=False,
                            run={"sample_rate": 1 / step}),
        (Measure("angle error", "deg", of),),
        (AtMost("angle error", 5e-4, 0.006, "asked"),
         Order("angle error", (2.5e-4, 1.25e-4), 1.8, DAMPED_ORDER)))


@cache
def _row(index: int) -> DiscRow:
    """A row of the table, with the disc exactly where the finger at 35 deg touches it."""
    row = SET_G_TABLE[index]
    x, y = disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
    return DiscRow(row.disc_radius, (float(x), float(y)), row.tension, row.degrees, row.forces)


def _disc(index: int) -> Trial:
    row = _row(index)

    def pose(run: Recording) -> float:
        return float(np.abs(angles(run)[-1] - row.degrees).max())

    def forces(run: Recording) -> float:
        found = np.array([run[f"{body}.contact.normal"][-1] for body in BODIES])
        return float(np.abs(found / row.forces - 1).max())

    targets = [target for step in (2e-3, 5e-4) for target in (
        AtMost("pose error", step, 0.01, "asked: statics of underactuated fingers"),
        AtMost("force error", step, 2e-4, "asked"))]
    return Trial(
        f"disc_{1e3 * row.disc_radius:g}mm_{row.tension:g}N",
        "a finger round a fixed disc, without friction, 1.5 s",
        lambda step: finger(SET_G, pull=row.tension, duration=1.5, step=step, disc=row),
        (Measure("pose error", "deg", pose), Measure("force error", "", forces)), tuple(targets))


def square(step: float) -> Mechanism:
    """A square, free in the plane, in the grasp of four fingers from four sides.

    The fingers lie in planes of their own and pass each other; each is pulled by itself.
    """
    centre = 0.011 - 0.042j
    names = [f"finger{i}" for i in range(1, 5)]
    fingers = [{
        "type": "finger", "name": name, "angle": np.pi / 2 * i, "material": "skin",
        "at": point(-centre * 1j**i), "lengths": SET_G.lengths, "radii": SET_G.radii,
        "masses": SET_G.masses, "guides": SET_G.guides, "damping": SET_G.damping,
        "limits": SET_G.limits,
        "springs": {"stiffness": 300, "from": SET_G.before[0], "to": SET_G.after[0]},
    } for i, name in enumerate(names)]
    return expand(load_scene({
        "run": {"duration": 4.0, "step": step, "sample_rate": 500.0}, "parts": fingers,
        "materials": {"skin": {"friction": 0.5}},
        "bodies": [{"name": "square", "mass": 0.05, "material": "skin", "at": [0.004, -0.003],
                    "angle": 0.4, "shapes": [{"type": "box", "size": [0.036, 0.036]}]}],
        "drives": [{"type": "pull", "name": f"{name}.pull", "tendon": name,
                    "value": {"ramp": {"to": 3.75, "over": 0.5}}} for name in names],
        "contacts": [{"between": ["finger*", "finger*"], "collide": False}]}))


def _pairs(run: Recording) -> np.ndarray:
    """Sizes of all contact forces [N] in the last second, a column for each pair, 0 if apart."""
    arrays = run.arrays
    count = len(run.mechanism.bodies)
    pair = arrays["contact_body"] * count + arrays["contact_other"]
    columns, place = np.unique(pair, return_inverse=True)
    sizes = np.zeros((len(run), len(columns)))
    sizes[arrays["contact_sample"], place] = np.linalg.norm(arrays["contact_force"], axis=1)
    return np.asarray(sizes[late(run, 1.0)])


def _rest(name: str, what: str, machine: Callable[[float], Mechanism]) -> Trial:
    def tension(run: Recording) -> float:
        found = np.asarray(run.arrays["tendon_tension"])[late(run, 1.0)]
        return float(np.ptp(found, axis=0).max())

    def creep(run: Recording) -> float:
        """How far any body's frame moves in the last second [m]."""
        at = run.arrays["body_pose"][late(run, 1.0)][..., :2]
        return float(np.linalg.norm(at[-1] - at[0], axis=-1).max())

    targets = [target for step in (2e-3, 5e-4) for target in (
        AtMost("noise of contacts", step, 1e-8, "asked: rest is rest, for every single force"),
        AtMost("noise of tensions", step, 1e-8, "asked"),
        AtMost("creep", step, 1e-8, "friction holds; what damping still closes is less"))]
    return Trial(
        name, what, machine,
        (Measure("noise of contacts", "N", lambda run: float(np.ptp(_pairs(run), axis=0).max())),
         Measure("noise of tensions", "N", tension), Measure("creep", "m", creep)),
        tuple(targets))


def trials() -> list[Trial]:
    return [_led(), _closing(), _disc(0), _disc(2),
            _rest("square", "a free square held by four fingers, in the fourth second", square)]
