"""Looks cords over: whether each has a direction from guide to guide, and something to pull."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from sandbox.engine.inspect_words import STRAIGHT, error, look, mm
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.scene.geometry import pose_of, to_world


def tendon_problems(model: Model) -> Iterator[Problem]:
    """Cords without a direction, which are errors, and those that pull on nothing."""
    bodies = model.mechanism.bodies
    for i, tendon in enumerate(model.mechanism.tendons):
        path = f"$.tendons[{i}]"
        guided = model.tendons.guide_body[model.tendons.guides(i)]
        points = [to_world(pose_of(bodies[body]), guide.at)
                  for body, guide in zip(guided, tendon.path, strict=True)]
        for k, (p, q) in enumerate(itertools.pairwise(points)):
            first, second = tendon.path[k], tendon.path[k + 1]
            after = (k + 1) % len(tendon.guides)
            gap = math.dist(p, q)
            reach = (first.radius + second.radius if first.side != second.side
                     else abs(first.radius - second.radius))
            if gap < STRAIGHT:
                yield error(path, tendon.name, f"its guides {k} and {after} coincide",
                             "move one of them: the cord between has no direction")
            elif gap < reach:
                yield error(
                    path, tendon.name, f"the wheels of its guides {k} and {after} are "
                    f"{mm(gap)} apart, the cord between them needs {mm(reach)}",
                    "move one of them, or make it smaller")
        if not model.bodies.free[guided].any():
            yield look(path, tendon.name, "passes no body that can move freely",
                           "it pulls on nothing")
