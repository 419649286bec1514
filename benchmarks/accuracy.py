"""Set G against statics and against an independent integration, as the verification tests do."""

from __future__ import annotations

from math import log2

import numpy as np

from benchmarks.measure import Figure
from sandbox.engine.simulate import simulate
from sandbox.mechanics.grasp import disc_centre
from sandbox.recording.recording import Recording
from tests.support.mechanisms import BODIES, HINGES, finger
from tests.support.reference import SET_G, SET_G_TABLE, Chain

STEPS = {5e-4: 0.006, 2.5e-4: 0.0015}
"""Steps [s] and the error of free closing that is allowed at each [deg]."""


def angles(run: Recording) -> np.ndarray:
    """The hinges' angles [deg], shape [samples, hinges]."""
    return np.degrees(np.stack([run[f"{hinge}.angle"] for hinge in HINGES], axis=1))


def closing() -> list[Figure]:
    """Free closing under 3 N for 0.06 s: largest error of any hinge, and its order in h."""
    errors = []
    for step in (1e-3, *STEPS):
        run = simulate(finger(SET_G, pull=3.0, duration=0.06, step=step, stops=False))
        truth = Chain(SET_G).integrate(run.time, 3.0)[:, :3]
        errors.append(float(np.abs(angles(run) - np.degrees(truth)).max()))
    return [
        *(Figure(f"free closing, error at h = {1e3 * step:g} ms", error, "deg", most=most)
          for (step, most), error in zip(STEPS.items(), errors[1:], strict=True)),
        Figure("free closing, order in h", log2(errors[1] / errors[2]), "", least=1.7),
    ]


def grasps(rows: int) -> list[Figure]:
    """The finger on fixed discs, without friction: worst rotation and worst force of a table.

    The table has three digits of a degree and four of a force, so that these are what is left.
    """
    rotation, force = 0.0, 0.0
    for row in SET_G_TABLE[:rows]:
        at = disc_centre(np.radians(35.0), 0.031, row.disc_radius, SET_G.radii[0])
        exact = type(row)(row.disc_radius, (float(at[0]), float(at[1])), row.tension,
                          row.degrees, row.forces)
        run = simulate(finger(SET_G, pull=row.tension, duration=1.5, step=5e-4, disc=exact))
        forces = np.array([run[f"{body}.contact.normal"][-1] for body in BODIES])
        rotation = max(rotation, float(np.abs(angles(run)[-1] - row.degrees).max()))
        force = max(force, float(np.abs(forces / row.forces - 1).max()))
    return [
        Figure("Set G on discs, rotations off by", rotation, "deg", most=1e-3),
        Figure("Set G on discs, forces off by", 100 * force, "%", most=0.02),
    ]


def figures(*, quick: bool = False) -> list[Figure]:
    """Both."""
    return [*closing(), *grasps(1 if quick else len(SET_G_TABLE))]
