"""The push that moves an object: by search in simulations, and what balance allows at most."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from sandbox.audit.bounds import known_by_sum, push_limits
from sandbox.audit.evidence import Evidence
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import Problem, SceneError
from sandbox.kinds.quantities import STRAY
from sandbox.numeric import Array, Flags
from sandbox.recording.recording import Recording
from sandbox.samples.grasps import Grasp
from sandbox.scene.geometry import centre_of
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import near, quoted

BEYOND = 8.0
"""Up to how many times the bound it is pushed, unless one asks for more."""
FIRST = 1.25
"""The first, evenly growing part of a push goes up to so many times what should move it."""
SLOWER = 4.0
"""By how much slower a push is repeated, to see whether it tells the same."""
AGREE = 0.02
"""Two paces that differ by less tell the same, as a share."""
REPEATS = 3
"""Of a push, at most, each slower than the one before."""
LONGEST = 20.0
"""No push takes more times as long as asked for."""
FINE = 120
"""Directions, at least, in which the bound is worked out."""
UNBOUNDED = 2.0
"""How many times all that presses on an object it is pushed with where there is no bound."""


class Own(NamedTuple):
    """What the scene itself does to a body while it is pushed."""

    stayed: tuple[tuple[str, float, float], ...]
    """Forces on it by drives that would change: name, from when on [s], what they stay at [N]."""
    way: float
    """How far it comes without a push [m]."""
    lasts: float
    """In how long a time [s]."""


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
    settled: Flags
    """Whether a slower push told the same, by :data:`AGREE`, or it did not move at all, [k]."""
    most: Array
    """Up to which it was pushed at most [N], [k]."""
    held: bool
    """Whether a hand held it at :attr:`at`."""
    own: Own
    """What it does without a push."""
    blurred: tuple[tuple[str, str], ...]
    """Bodies that touch with several normals, of whose forces the sum alone is recorded: they are
    taken to carry anything, so that the bound may be too large, or none."""
    around: Array
    """More directions, every so many of which are those pushed in [rad], [f]."""
    bounds: Array
    """Beyond which no forces balance it at rest in the pose and with the pulls at :attr:`at` [N],
    [f]: from there on it gives; inf without one, nan where nothing balances it as it is."""

    @property
    def bound(self) -> Array:
        """Those of :attr:`bounds` in the directions pushed in [N], [k]."""
        return self.bounds[::len(self.around) // len(self.directions)]


def pushes(
    mechanism: Mechanism, body: str, *, at: float, over: float = 2.0, count: int = 12,
    limit: float | None = None, beyond: float = BEYOND,
    progress: Callable[[float], None] | None = None,
) -> Pushes:
    """Push a body at its centre of mass, in ``count`` directions, with a force that grows.

    It grows evenly to a little more than should move it, then doubles again and again. What has
    moved it is pushed again, more slowly, until two paces tell the same force. How far it has come
    is told against a run without the push, at the same time. Forces on it by drives of the scene
    stay as they are when it begins, unless a controller or an event sets them.

    Args:
        mechanism: a hand with what it holds; its own drives and controllers go on.
        body: the object.
        at: from when on it is pushed [s]; until then the mechanism is left alone.
        over: how long a push grows evenly, and then to twice as much each time [s].
        count: of directions, evenly round.
        limit: how far it may come [m]; by default :data:`STRAY` of its size, as of what is held.
        beyond: up to how many times the bound it is pushed. Without one (0, too), up to
            ``UNBOUNDED * beyond / BEYOND`` times all that presses on it.
        progress: called now and then with the fraction done.

    Raises:
        SceneError: a body that cannot be pushed; nothing touches it then.
        SimulationDiverged: a simulation did.
    """
    number = _object(mechanism, body)
    tell = progress or (lambda _: None)
    before = simulate(_until(mechanism, at))
    grasp = Grasp(before, number)
    last = grasp.sample == len(before) - 1
    if not last.any():
        raise SceneError([Problem(f"nothing touches {quoted(body)} at t = {before.time[-1]:.6g} s",
                                  "at", allowed="a time at which it is held")])
    finer = -(-FINE // count)
    around = 2 * np.pi * np.arange(count * finer) / (count * finer)
    evidence = Evidence(before)
    bounds = push_limits(evidence, number, around.tolist())
    names = [each.name for each in mechanism.bodies]
    blurred = tuple((names[a], names[b]) for a, b in known_by_sum(evidence, number))
    directions, bound = around[::finer], bounds[::finer]
    pressed = float(grasp.push[last].sum())
    known = np.isfinite(bound) & (bound > 0)
    most = np.where(known, beyond * np.where(known, bound, 0.0),
                    beyond / BEYOND * UNBOUNDED * pressed)
    way = limit if limit is not None else STRAY * grasp.size
    first = np.where(known, FIRST / beyond * most, most / BEYOND)
    alone = _Alone(mechanism, body, before, over, way)
    found, settled = [], []
    for k in range(count):
        tell(k / count)
        force, same = _moving(alone, float(directions[k]), min(first[k], most[k]), float(most[k]))
        found.append(force)
        settled.append(same)
    return Pushes(body, at, way, directions, np.array(found), np.array(settled), most,
                  bool(grasp.held[-1]), alone.own(), blurred, around, bounds)


class _Alone:
    """A mechanism whose body is not pushed, and how far it comes apart from there if it is."""

    def __init__(
        self, mechanism: Mechanism, body: str, before: Recording, over: float, limit: float,
    ) -> None:
        """``before`` is its run up to the push, ``limit`` how far it may come [m]."""
        self.at = at = before.mechanism.run.duration
        self.mechanism = _until(mechanism, at + LONGEST * over)
        self.body, self.over, self.limit = body, over, limit
        self.number = _object(mechanism, body)
        self._idle = Simulation(self.mechanism)
        self._idle.run(self._steps(at))
        self._stay = _held_at(self._idle, body, before)
        self._run = self._idle.recording()

    def upto(self, time: float) -> Recording:
        """Its motion up to a time [s] at least."""
        if len(self._run) == 0 or self._run.time[-1] < time:
            self._idle.run(self._steps(time))
            self._run = self._idle.recording()
        return self._run

    def moved_at(self, direction: float, growth: Sequence[tuple[float, float]]) -> float:
        """How long after ``at`` it is beyond the limit [s]; inf if it never is.

        Args:
            direction: of the push [rad].
            growth: time after ``at`` [s] and force [N], from (0, 0) on.
        """
        pushed = Simulation(_pushed(self.mechanism, self.body, self.at, direction, growth))
        pushed.run(self._steps(self.at))
        for name, force in self._stay.items():
            pushed.set(name, force)
        for after, _ in growth[1:]:
            pushed.run(self._steps(self.at + after))
            run = pushed.recording()
            apart = Grasp(run, self.number).apart(
                Grasp(self.upto(float(run.time[-1])), self.number))
            beyond = np.flatnonzero(apart > self.limit)
            if len(beyond):
                return float(run.time[beyond[0]]) - self.at
            if pushed.finished:
                break
        return np.inf

    def own(self) -> Own:
        """What the scene does to it by itself, as long as it was looked at."""
        run = self._run
        begin = self._begin(run)
        way = Grasp(run, self.number).moved(np.full(len(run), begin))[begin:]
        return Own(self._changes(), float(way.max(initial=0.0)),
                   float(run.time[-1] - run.time[begin]))

    def _changes(self) -> tuple[tuple[str, float, float], ...]:
        """Of what stays that which would change: name, from when on [s], where it stays [N]."""
        if not self._stay:
            return ()
        run = simulate(self.mechanism)
        begin, found = self._begin(run), []
        for name, force in self._stay.items():
            changes = np.flatnonzero(run[f"{name}.value"][begin:] != force)
            if len(changes):
                found.append((name, float(run.time[begin + max(0, changes[0] - 1)]), force))
        return tuple(found)

    def _begin(self, run: Recording) -> int:
        return max(0, int(np.searchsorted(run.time, self.at, side="right")) - 1)

    def _steps(self, time: float) -> int:
        return -int(-time / self.mechanism.run.step // 1)


def _held_at(simulation: Simulation, body: str, before: Recording) -> dict[str, float]:
    """Keep the forces on a body by drives what they are; which those are, and how large [N].

    Those that a controller or an event sets go on.
    """
    kept = {}
    kinds, pushed = before.model.drives, before.model.names.body[body]
    for i, drive in enumerate(before.mechanism.drives):
        if kinds.kind[i].gives == "force" and kinds.target[i] == pushed:
            force = float(before[f"{drive.name}.value"][-1])
            try:
                simulation.set(drive.name, force)
            except SceneError:
                continue
            kept[drive.name] = force
    return kept


def _moving(alone: _Alone, direction: float, first: float, most: float) -> tuple[float, bool]:
    """The force that moves a body [N], inf if none does, and whether a slower push told the same.

    Args:
        alone: the body.
        direction: of the push [rad].
        first: up to which it grows evenly [N].
        most: up to which it is pushed [N].
    """
    over = alone.over
    growth = [(0.0, 0.0), (over, first)]
    while growth[-1][1] < most * (1 - AGREE):
        time, force = growth[-1]
        more = min(2 * force, most)
        growth.append((time + (more / force - 1) * over, more))
    time = alone.moved_at(direction, growth)
    if np.isinf(time):
        return np.inf, True
    force = float(np.interp(time, *np.transpose(growth)))
    part = int(np.searchsorted([each for each, _ in growth[1:-1]], time))
    (begin, low), (end, high) = growth[part:part + 2]
    rate = (high - low) / (end - begin)
    for _ in range(REPEATS):
        rate = min(rate / SLOWER, FIRST * force / over)
        lasts = FIRST * force / rate
        if lasts > LONGEST * over:
            break
        time = alone.moved_at(direction, [(0.0, 0.0), (lasts, FIRST * force)])
        if np.isinf(time):
            break
        former, force = force, rate * time
        if abs(force - former) <= AGREE * force:
            return force, True
    return force, False


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
    mechanism: Mechanism, body: str, at: float, direction: float,
    growth: Sequence[tuple[float, float]],
) -> Mechanism:
    name, taken = "study_push", {drive.name for drive in mechanism.drives}
    while name in taken:
        name += "_"
    spec = next(each for each in mechanism.bodies if each.name == body)
    before = [[0.0, 0.0]] if at > 0 else []
    push = Mechanism.model_validate({"drives": [{
        "type": "force", "name": name, "body": body, "at": centre_of(spec),
        "direction": (float(np.cos(direction)), float(np.sin(direction))),
        "value": {"table": [*before, *([at + after, force] for after, force in growth)]}}]})
    return mechanism.model_copy(update={"drives": (*mechanism.drives, *push.drives)})
