"""Which points of bodies are marked: those that the view traces, fingertips, centres of mass."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.kinds.layers import EVERY, meant
from sandbox.model.model import Model
from sandbox.picture.elements.bodies import colour_of
from sandbox.picture.geometry import shape_points
from sandbox.picture.palette import INK, TRACES, Colour, mixed
from sandbox.picture.run_data import RunData
from sandbox.scene.elements.settings import View
from sandbox.scene.values.colours import rgb

XY = tuple[float, float]
Place = tuple[int, XY]
DARKER = 0.3
"""How much darker a way is than the body that goes it."""
MOST_NAMED = 6
"""Of no more than so many ways the bodies' names stand at their ends."""
PIECES = 12
"""Between marks of time, at most."""


def fingertip(run: RunData, body: int) -> XY:
    """The point of a finger's last phalanx that is farthest from its first hinge, [m].

    Of one without shapes or hinge it is the body's origin.
    """
    joints = run.model.joints
    hinges = [joints.anchor[k, 1] for k in joints.hinges.tolist() if joints.bodies[k, 1] == body]
    shapes = run.mechanism.bodies[body].shapes
    if not shapes or not hinges:
        return 0.0, 0.0
    points = np.concatenate([shape_points(shape) for shape in shapes])
    # the outline's corners beside the tip are as far from the hinge on either side of it
    far = points[np.hypot(*(points - hinges[0]).T).argmax()]
    return float(far[0]), float(far[1])


def _centre(run: RunData, body: int) -> Place:
    x, y = run.arrays["body_centre"][body].tolist()
    return body, (x, y)


def traced(run: RunData, view: View, patterns: Sequence[str]) -> list[Place]:
    """The points whose ways are drawn of the bodies that the patterns fit.

    Those of ``view.traces``. Of bodies without one the fingertip or the centre of mass, where they
    are named, or where nothing at all is traced; of all bodies, the tips if there are fingers.
    """
    names = [body.name for body in run.mechanism.bodies]
    chosen = set(meant(patterns, run.mechanism.bodies))
    named = [(names.index(trace.body), trace.at) for trace in view.traces]
    found = [place for place in named if place[0] in chosen]
    if tuple(patterns) == EVERY and found:
        return found
    tips = [names.index(group.bodies[-1]) for group in run.mechanism.groups
            if group.kind == "finger" and group.bodies and group.bodies[-1] in names]
    tips = [body for body in tips if body in chosen]
    given = {body for body, _ in found}
    found += [(body, fingertip(run, body)) for body in tips if body not in given]
    if tuple(patterns) == EVERY and found:
        return found
    given |= set(tips)
    return found + [_centre(run, body) for body in sorted(chosen - given) if _moves(run, body)]


def trace_colours(model: Model, bodies: Sequence[int]) -> list[Colour]:
    """What tells the ways of points of some bodies apart.

    The bodies' own colours, darker, where the scene gives each another one; else :data:`TRACES`.
    """
    own = [colour_of(model, model.mechanism.bodies[body]) for body in bodies]
    given = [mixed(rgb(each), INK, DARKER) for each in own if each]
    if len(own) > 1 and len(set(given)) == len(own):
        return given
    return [TRACES[k % len(TRACES)] for k in range(len(own))]


def trace_names(model: Model, bodies: Sequence[int]) -> list[str]:
    """What stands at the ends of ways: names of bodies, of a few different ones; else nothing."""
    alone = len(bodies) < 2 or len(bodies) > MOST_NAMED or len(set(bodies)) < len(bodies)
    return ["" if alone else model.mechanism.bodies[body].name for body in bodies]


def marked(run: RunData, view: View, patterns: Sequence[str]) -> list[Place]:
    """The points whose velocity is shown: of each body that moves those traced, else its centre."""
    names = [body.name for body in run.mechanism.bodies]
    chosen = [body for body in meant(patterns, run.mechanism.bodies) if _moves(run, body)]
    named = [(names.index(trace.body), trace.at) for trace in view.traces]
    given = {body for body, _ in named}
    return [place for place in named if place[0] in chosen] + [
        _centre(run, body) for body in chosen if body not in given]


def _moves(run: RunData, body: int) -> bool:
    return not bool(run.model.bodies.fixed[body])


def round_interval(duration: float) -> float:
    """The time between marks [s]: 1, 2 or 5 times a power of ten, at most :data:`PIECES` in all.

    >>> round_interval(0.5), round_interval(3.0)
    (0.05, 0.5)
    """
    least = duration / PIECES
    if not least > 1e-300:
        return 1.0
    power = 10.0 ** math.floor(math.log10(least))
    return float(next((step * power for step in (1.0, 2.0, 5.0)
                       if step * power >= least * (1 - 1e-9)), 10.0 * power))


def finger_names(model: Model) -> list[tuple[str, int]]:
    """Names of the finger groups with the body each begins with."""
    index = model.names.body
    return [(group.name, index[group.bodies[0]]) for group in model.mechanism.groups
            if group.kind == "finger" and group.bodies and group.bodies[0] in index]
