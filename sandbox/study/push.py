"""The push that moves an object: by search in simulations, and what balance allows at most."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.pushes import push_limits
from sandbox.engine.simulate import simulate
from sandbox.errors import Problem, SceneError
from sandbox.kinds.quantities import STRAY
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.grasps import Grasp
from sandbox.scene.geometry import centre_of
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import near, quoted

BEYOND = 1.25
"""By how much pushes go beyond the bound, unless one asks for more."""
FINE = 120
"""Directions, at least, in which the bound is worked out."""
UNBOUNDED = 2.0
"""How many times all that presses on an object it is pushed with where there is no bound."""


class Pushes(NamedTuple):
    """What :func:`pushes` found."""

    body: str
    at: float
    """From when on it was pushed [s]."""
    limit: float
    """How far it may come [m]."""
    directions: Array
    """Counter-clockwise from x [rad], [k]."""
    found: Array
    """At which it had come farther than the limit [N], [k]; inf if it never did."""
    most: Array
    """Up to which it was pushed [N], [k]."""
    held: bool
    """Whether a hand held it at :attr:`at`."""
    around: Array
    """More directions, every so many of which are those pushed in [rad], [f]."""
    bounds: Array
    """Beyond which no forces balance it, by the pose and the pulls at :attr:`at` [N], [f]; inf
    without one, nan where nothing balances it as it is."""

    @property
    def bound(self) -> Array:
        """Those of :attr:`bounds` in the directions pushed in [N], [k]."""
        return self.bounds[::len(self.around) // len(self.directions)]


def pushes(
    mechanism: Mechanism, body: str, *, at: float, over: float = 2.0, count: int = 12,
    limit: float | None = None, beyond: float = BEYOND,
    progress: Callable[[float], None] | None = None,
) -> Pushes:
    """Push a body at its centre of mass, in ``count`` directions, with a force that grows evenly.

    Args:
        mechanism: a hand with what it holds; its own drives and controllers go on.
        body: the object.
        at: from when on it is pushed [s]; until then the mechanism is left alone.
        over: how long a push grows [s].
        count: of directions, evenly round.
        limit: how far it may come [m]; by default :data:`STRAY` of its size, as of what is held.
        beyond: up to how many times the bound it is pushed; where there is none the push grows by
            as much more.
        progress: called with the fraction done.

    Raises:
        SceneError: a body that cannot be pushed; nothing touches it then.
        SimulationDiverged: a simulation did.
    """
    number = _object(mechanism, body)
    tell = progress or (lambda _: None)
    base = simulate(_until(mechanism, at))
    grasp = Grasp(base, number)
    last = grasp.sample == len(base) - 1
    if not last.any():
        raise SceneError([Problem(f"nothing touches {quoted(body)} at t = {base.time[-1]:.6g} s",
                                  "at", allowed="a time at which it is held")])
    finer = -(-FINE // count)
    around = 2 * np.pi * np.arange(count * finer) / (count * finer)
    bounds = push_limits(Evidence(base), number, around.tolist())
    directions, bound = around[::finer], bounds[::finer]
    pressed = float(grasp.push[last].sum())
    known = np.isfinite(bound) & (bound > 0)
    most = np.where(known, beyond * np.where(known, bound, 0.0),
                    beyond / BEYOND * UNBOUNDED * pressed)
    way = limit if limit is not None else STRAY * grasp.size
    found = []
    for k in range(count):
        tell(k / count)
        run = simulate(_pushed(mechanism, body, at, over, float(directions[k]), float(most[k])))
        found.append(_moved_at(run, number, at, way) * most[k] / over)
    return Pushes(body, at, way, directions, np.array(found), most,
                  bool(grasp.held[-1]), around, bounds)


def _object(mechanism: Mechanism, name: str) -> int:
    names = [body.name for body in mechanism.bodies]
    free = [body.name for body in mechanism.bodies if body.motion == "dynamic"]
    if name not in free:
        what = "does not move freely" if name in names else "is no body"
        raise SceneError([Problem(f"{quoted(name)} {what}", "body", hint=near(name, free),
                                  allowed="a body that moves freely")])
    return names.index(name)


def _until(mechanism: Mechanism, time: float) -> Mechanism:
    return mechanism.model_copy(update={
        "run": mechanism.run.model_copy(update={"duration": time}), "expect": ()})


def _pushed(
    mechanism: Mechanism, body: str, at: float, over: float, direction: float, most: float,
) -> Mechanism:
    name, taken = "study_push", {drive.name for drive in mechanism.drives}
    while name in taken:
        name += "_"
    spec = next(each for each in mechanism.bodies if each.name == body)
    before = [[0.0, 0.0]] if at > 0 else []
    push = Mechanism.model_validate({"drives": [{
        "type": "force", "name": name, "body": body, "at": centre_of(spec),
        "direction": (float(np.cos(direction)), float(np.sin(direction))),
        "value": {"table": [*before, [at, 0.0], [at + over, most]]}}]})
    return _until(mechanism, at + over).model_copy(
        update={"drives": (*mechanism.drives, *push.drives)})


def _moved_at(run: Recording, body: int, at: float, limit: float) -> float:
    """How long after ``at`` a body has come farther than a limit [s]; inf if it never does."""
    grasp = Grasp(run, body)
    begin = max(0, int(np.searchsorted(run.time, at, side="right")) - 1)
    beyond = np.flatnonzero(grasp.moved(np.full(len(run), begin))[begin:] > limit)
    return float(run.time[begin + beyond[0]] - at) if len(beyond) else np.inf
