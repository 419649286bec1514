"""Looks loads over: whether their laws have a value where the run starts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.engine.inspect_words import error, look
from sandbox.errors import Problem
from sandbox.model.loads import motion_of
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.geometry import pose_of, to_world

PLACES = ("[0]", "[1]", "")


def load_problems(model: Model) -> Iterator[Problem]:
    """Laws without a value at t = 0, which are errors; liquids that lift nothing."""
    given, loads = model.mechanism.loads, model.loads
    for i in range(len(loads.name)):
        load, body = given[loads.load[i]], model.mechanism.bodies[loads.body[i]]
        path, law = f"$.loads[{loads.load[i]}]", loads.law[i]
        if law is None:
            if not len(loads.outline(i)) and body.name in load.bodies:
                yield look("no-effect", path, load.name, f"{body.name!r} has no area that a liquid "
                           "could lift", "give it a shape")
            continue
        motion = motion_of(model, i, *_start(model, int(loads.body[i])), np.zeros((3, 1)),
                           np.zeros(1))
        for k, value in enumerate(law.at(motion)[:, 0]):
            part = law.parts[k]
            if part is not None and not np.isfinite(value):
                field = ("torque" if k == 2 else
                         "acceleration" if loads.per_mass[i] else "force")
                there = ", ".join(f"{name} = {float(motion[name][0]):.4g}"
                                  for name in sorted(part.names))
                yield error(
                    "undefined-law", f"{path}.{field}{PLACES[k]}", load.name,
                    f"has no finite value on {body.name!r} at t = 0" + (there and f", {there}"),
                    "a division by zero, or out of range")


def _start(model: Model, i: int) -> tuple[Array, Array]:
    """Pose of a body's centre of mass, and its velocity, at t = 0, [3, 1]."""
    body, centre = model.mechanism.bodies[i], model.bodies.centre[i]
    x, y = to_world(pose_of(body), (float(centre[0]), float(centre[1])))
    return (np.array([[x], [y], [body.angle]]),
            np.array([[body.velocity[0]], [body.velocity[1]], [body.angular_velocity]]))
