"""Bodies so unlike in mass that rounding shows.

What a step solves has the inverse masses of all that hangs together in one system of equations.
Its rounding grows with the ratio of the heaviest to the lightest: measured on boxes in a stack and
links in a chain, two or five of them, resting forces are off by up to 1e-15 times that ratio, gaps
of joints stay at 1e-10 m up to 1e7, and from 1e10 on a stack is not carried any more. How light a
body is hangs on where it is pushed: at r from its centre of mass it answers with 1/m + r^2/I.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.engine.inspect_groups import groups, linked
from sandbox.engine.inspect_words import look, mm
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags
from sandbox.scene.geometry import outline
from sandbox.wording import quoted

UNLIKE = 1e6
"""Heaviest to lightest, up to which the engine is held to its digits."""
WRONG = 1e10
"""From here on forces may be."""
SLENDER = 10.0
"""1 + m r^2/I of bodies that are shaped like any other: a rod pushed at its end has 4."""


def mass_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """What hangs together and is further apart than :data:`UNLIKE`: the two bodies.

    ``allowed`` are the pairs that may touch, [nb, nb].
    """
    bodies, free = model.bodies, np.flatnonzero(model.bodies.free)
    reach = _reaches(model)
    share = np.ones(len(bodies.name))
    share[free] += reach[free] ** 2 * bodies.mass[free] / bodies.inertia[free]
    lightest = np.where(share > SLENDER, bodies.mass / share, bodies.mass)
    if not len(free) or bodies.mass[free].max() <= UNLIKE * lightest[free].min():
        return
    for group in groups(model, linked(model, contacts=allowed)):
        light = int(group[lightest[group].argmin()])
        others = group[group != light]
        if not len(others):
            continue
        heavy = int(others[bodies.mass[others].argmax()])
        ratio = float(bodies.mass[heavy] / lightest[light])
        if ratio > UNLIKE:
            turned = "" if share[light] <= SLENDER else (
                f", but with {bodies.inertia[light]:.4g} kg m^2 answers a push at "
                f"{mm(float(reach[light]))} from its centre as {lightest[light]:.2g} kg would,")
            yield look(
                "mass-ratio", f"$.bodies[{light}]", bodies.name[light],
                f"has {bodies.mass[light]:.4g} kg{turned} where {quoted(bodies.name[heavy])} has "
                f"{bodies.mass[heavy]:.4g} kg: connected masses differ by 1 : {ratio:.2g}; "
                f"rounding errors show beyond 1 : {UNLIKE:.0e}",
                f"forces are right to {1e-15 * ratio:.0e} of the largest" if ratio < WRONG else
                "forces may be wrong: make the two more alike")


def _reaches(model: Model) -> Array:
    """How far from its centre of mass a body can be pushed [m], [nb]."""
    bodies, joints, tendons = model.bodies, model.joints, model.tendons
    reach = np.zeros(len(bodies.name))
    for on, points in ((joints.bodies.ravel(), joints.anchor.reshape(-1, 2)),
                       (tendons.guide_body, tendons.guide_at)):
        off = points - bodies.centre[on]
        np.fmax.at(reach, on, np.hypot(off[:, 0], off[:, 1]))
    for body, spec in enumerate(model.mechanism.bodies):
        for shape in spec.shapes:
            off = np.array(outline(shape)) - bodies.centre[body]
            reach[body] = max(reach[body], float(np.hypot(off[:, 0], off[:, 1]).max()))
    return reach
