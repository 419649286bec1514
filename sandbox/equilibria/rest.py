"""Equilibria of a scene, without waiting for them: :func:`rest`, as ``sandbox.rest``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sandbox.engine.inspect_control import Runnable, checked
from sandbox.equilibria.balance import PoseBalance
from sandbox.equilibria.restless import refuse, remarks
from sandbox.equilibria.search import Search, Unsettled
from sandbox.equilibria.starts import Start, placed
from sandbox.errors import Problem, SceneError, SimulationDiverged
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.contacts import TOUCH
from sandbox.samples.yielding import NOTHING, Yield, Yielding
from sandbox.scene.geometry import centre_of, reach_of
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, near, quoted

SAME = 1e-6
"""Poses that differ by a smaller share of the size are one and the same."""
MOVED = 1e-3
"""What has a smaller share in a motion does not move in it."""
MOST_STAGES = 100_000
STABLE, UNSTABLE, NEUTRAL, UNTOLD = "stable", "unstable", "neutral", "not told"


@dataclass(frozen=True)
class AtRest:
    """One equilibrium.

    What it reads like: ``found["finger.tendon.tension"]``, any quantity of a run, at rest.
    """

    recording: Recording
    """Of one sample: bodies at rest, all forces that hold them there."""
    start: str
    """From where it was found, in words."""
    balance: PoseBalance | None
    """Free motions and what answers them; None where stiffness is not told."""
    untold: str
    """Why not."""
    steps: int
    """Steps of the engine that it took."""
    size: float
    """Of the mechanism [m]."""

    def __repr__(self) -> str:
        return f"<AtRest of {self.recording.mechanism.name!r} from {self.start}: {self.stability}>"

    def __getitem__(self, quantity: str) -> float:
        """A quantity or expression at rest, in SI; as :class:`sandbox.Recording` has it.

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
        """
        return float(self.recording.within(quantity, slice(-1, None))[0])

    @cached_property
    def left(self) -> float:
        """The largest force that is left over on any body: mass times acceleration [N]."""
        a, free = self.recording.arrays, self.recording.model.bodies.free
        forces = a["body_mass"][free, None] * a["body_acceleration"][0, free, :2]
        return float(np.hypot(*forces.T).max(initial=0.0))

    @cached_property
    def modes(self) -> Array:
        """w^2 of small free motions, lowest first [1/s^2]; nan-free, empty where none is free.

        Above 0 they are frequencies squared, below 0 what grows as exp(sqrt(-w^2) t).
        """
        return self.balance.modes()[0] if self.balance is not None else np.zeros(0)

    @cached_property
    def stability(self) -> str:
        """``stable``, ``unstable``, ``neutral`` (nothing answers some motion), ``not told``."""
        if self.balance is None:
            return UNTOLD
        if not len(self.modes):
            return STABLE
        stiffness = (self.balance.stiffness + self.balance.stiffness.T) / 2
        least = float(np.linalg.eigvalsh(stiffness)[0])
        nothing = NOTHING * self.balance.largest / self.size
        return STABLE if least > nothing else NEUTRAL if least >= -nothing else UNSTABLE

    @cached_property
    def loose(self) -> tuple[str, ...]:
        """Bodies that motions answered by nothing move, as a round one that turns about itself."""
        if self.balance is None or not len(self.modes):
            return ()
        stiffness = (self.balance.stiffness + self.balance.stiffness.T) / 2
        values, vectors = np.linalg.eigh(stiffness)
        nothing = NOTHING * self.balance.largest / self.size
        motions = self.balance.free @ vectors[:, np.abs(values) <= nothing]
        moved = np.abs(motions).max(axis=1, initial=0.0).reshape(-1, 3).max(axis=1, initial=0.0)
        names = self.recording.model.bodies.name
        return tuple(names[i] for i in self.balance.bodies[moved > MOVED].tolist())

    @cached_property
    def sticking(self) -> tuple[str, ...]:
        """What dry friction holds: pairs that touch and joints, by name."""
        a, model = self.recording.arrays, self.recording.model
        names, found = model.bodies.name, []
        contacts = self.recording.contacts
        for row in np.flatnonzero(np.abs(contacts.tangential) > TOUCH).tolist():
            found.append(f"{names[a['contact_body'][row]]}/{names[a['contact_other'][row]]}")
        found += [model.joints.name[j] for j in model.joints.rubbed.tolist()
                  if abs(a["joint_friction"][0, j]) > TOUCH]
        return tuple(found)

    def stiffness(self, body: str) -> Yield:
        """How a body gives way to a small push; its ``stiffness()`` is that along x, y and in turn.

        Below 0 along what an unstable equilibrium falls.

        Raises:
            SceneError: no body that moves freely; a mechanism whose stiffness is not told.
        """
        model = self.recording.model
        known_body(self.recording.mechanism, body)
        if self.untold:
            raise SceneError([Problem("no-rest",
                                      f"stiffness can't be told with {self.untold}", "body")])
        number = model.names.body[body]
        spec = self.recording.mechanism.bodies[number]
        size = reach_of(spec, centre_of(spec)) or self.size
        return Yielding(self.recording, 0, size).of(number, signed=True)


@dataclass(frozen=True)
class RestFound:
    """What a search came to."""

    rests: tuple[AtRest, ...]
    """Equilibria, each once, in the order in which they were found."""
    failed: tuple[tuple[str, str], ...]
    """Starts that did not come to rest, and why."""
    remarks: tuple[str, ...]
    """What is to be known of how the scene was read."""

    def __repr__(self) -> str:
        return f"<RestFound: {len(self.rests)} at rest, {len(self.failed)} failed>"


def rest(
    scene: Runnable, *, at: float | None = None, starts: Sequence[Start] = (),
    stages: int | None = None,
) -> RestFound:
    """Find where a scene comes to rest, and judge it, without waiting for it.

    Without ``starts`` the drives go slowly from their values at t = 0 to those at ``at``, from the
    scene's own pose: a slow load's equilibrium. With ``starts`` each begins at its own pose, with
    the drives at their values at ``at``.

    Args:
        scene: a scene, a mechanism or what :func:`sandbox.load_scene` takes.
        at: the time whose values of drives are held [s]; by default the end of the scene.
        starts: poses to begin at, as mappings of ``JOINT.angle``, ``BODY.x``, ``BODY.y`` or
            ``BODY.angle`` to values in SI.
        stages: in how many the drives go there, without ``starts``; by default 40, with dry
            friction 200.

    Raises:
        SceneError: controllers, events at a time, nothing that moves freely, a start that names
            what is not there; or no start that comes to rest, with the reasons.
    """
    mechanism = checked(scene, ())
    refuse(mechanism)
    sensible(mechanism, at, stages)
    search = Search(mechanism, mechanism.run.duration if at is None else at)
    rests: list[AtRest] = []
    failed: list[tuple[str, str]] = []
    for start in starts or (None,):
        words = told(start)
        before = search.relaxation.moved
        try:
            if start is None:
                search.follow(stages)
            else:
                search.start(placed(search, start))
            found = settled(search, words, before)
        except Unsettled as error:
            failed.append((words, str(error)))
            continue
        except SimulationDiverged as error:
            failed.append((words, f"{error.culprit}: {error.reason}"))
            continue
        if not any(_same(found, one) for one in rests):
            rests.append(found)
    if not rests:
        raise SceneError([Problem("no-rest", f"it does not come to rest{words}: {reason}", "rest")
                          for words, reason in failed])
    return RestFound(tuple(rests), tuple(failed), tuple(remarks(mechanism, search, at)))


def known_body(mechanism: Mechanism, body: str) -> None:
    """See that a body moves freely.

    Raises:
        SceneError: there is none of that name that does, with a near miss.
    """
    free = [each.name for each in mechanism.bodies if each.motion == "dynamic"]
    if body not in free:
        raise SceneError([Problem("name-not-found",
                                  f"{quoted(body)} is no body that moves freely", "body",
                                  allowed=listed(free), hint=near(body, free))])


def sensible(mechanism: Mechanism, at: float | None, stages: int | None) -> None:
    """See that a time is within the run, and that stages are some that can be gone through.

    Raises:
        SceneError: they are not.
    """
    duration = mechanism.run.duration
    if at is not None and not 0 <= at <= duration:
        raise SceneError([Problem("bad-time", f"{at:g} s is not within the run", "at",
                                  allowed=f"0 to {duration:g} s")])
    if stages is not None and not 1 <= stages <= MOST_STAGES:
        raise SceneError([Problem("bad-argument", f"{stages} stages are not gone through", "stages",
                                  allowed=f"1 to {MOST_STAGES}")])


def told(start: Start | None) -> str:
    """A start in words."""
    if start is None:
        return ""
    return " from " + ", ".join(f"{name} = {value:.6g}" for name, value in start.items())


def settled(search: Search, words: str, before: int) -> AtRest:
    """The equilibrium that a search settles in from where its bodies are.

    Raises:
        Unsettled: it does not.
        SimulationDiverged: the motion stopped being finite.
    """
    balance = search.settle()
    if balance is None:
        search.still.move(search.drive, kept=True)
    run = search.still.recording() if balance is None else balance.run
    untold = search.untold or ("" if balance is not None else "motions that Newton's method missed")
    return AtRest(run, words.removeprefix(" from "), balance, untold,
                search.relaxation.moved - before, search.size)


def _same(one: AtRest, other: AtRest) -> bool:
    way = np.abs(one.recording.arrays["body_pose"] - other.recording.arrays["body_pose"])
    return bool(max(way[..., :2].max() / one.size, way[..., 2].max()) <= SAME)
