"""Static equilibria of a scene and their stability: :func:`rest`, as ``sandbox.rest``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sandbox.engine.inspect_control import Runnable, checked
from sandbox.equilibria.settle import (
    PoseBalance,
    Settler,
    Start,
    Unsettled,
    angles,
    place_start,
    positions,
)
from sandbox.errors import Problem, SceneError, SimulationDiverged
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.contacts import TOUCH
from sandbox.samples.stiffness import Linearization, PushResponse
from sandbox.scene.geometry import centre_of, reach_of
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, near, quoted

SAME = 1e-6  # difference, relative to the size, of poses that count as one
MOVED = 1e-3  # part in a motion below which a body does not move in it
MAX_STAGES = 100_000
STABLE, UNSTABLE, NEUTRAL, UNKNOWN = "stable", "unstable", "neutral", "unknown"


@dataclass(frozen=True)
class AtRest:
    """One equilibrium; ``found["finger.tendon.tension"]`` is a quantity of it."""

    recording: Recording  #: one sample: the bodies at rest, and all forces
    start: str  #: the start that led to it, as text
    balance: PoseBalance | None  #: free motions and stiffness; None where the stiffness is unknown
    untold: str  #: why it is unknown
    steps: int  #: steps of the engine
    size: float  #: of the mechanism [m]

    def __repr__(self) -> str:
        return f"<AtRest of {self.recording.mechanism.name!r} from {self.start}: {self.stability}>"

    def __getitem__(self, quantity: str) -> float:
        """A quantity or an expression, SI; as of :class:`sandbox.Recording`.

        Raises:
            UnknownQuantityError: not in the catalogue; with a suggestion.
        """
        return float(self.recording.within(quantity, slice(-1, None))[0])

    @cached_property
    def left(self) -> float:
        """The largest residual force on a body: mass times acceleration [N]."""
        a, free = self.recording.arrays, self.recording.model.bodies.free
        forces = a["body_mass"][free, None] * a["body_acceleration"][0, free, :2]
        return float(np.hypot(*forces.T).max(initial=0.0))

    @cached_property
    def modes(self) -> Array:
        """w^2 of small free motions, lowest first [1/s^2].

        Positive ones are squared angular frequencies; with negative ones motions grow as
        exp(sqrt(-w^2) t).
        """
        return self.balance.modes() if self.balance is not None else np.zeros(0)

    @cached_property
    def stability(self) -> str:
        """``stable``, ``unstable``, ``neutral`` (a motion without stiffness), ``unknown``."""
        if self.balance is None:
            return UNKNOWN
        if not len(self.modes):
            return STABLE
        values, _, zero = self.balance.soft
        return STABLE if values[0] > zero else NEUTRAL if values[0] >= -zero else UNSTABLE

    @cached_property
    def loose(self) -> tuple[str, ...]:
        """Bodies with a motion without stiffness, as a disc that turns about its centre."""
        if self.balance is None or not len(self.modes):
            return ()
        values, vectors, zero = self.balance.soft
        motions = self.balance.free @ vectors[:, np.abs(values) <= zero]
        moved = np.abs(motions).max(axis=1, initial=0.0).reshape(-1, 3).max(axis=1, initial=0.0)
        names = self.recording.model.bodies.name
        return tuple(names[i] for i in self.balance.bodies[moved > MOVED].tolist())

    @cached_property
    def sticking(self) -> tuple[str, ...]:
        """Contacts and joints with a dry friction force, by name."""
        a, model = self.recording.arrays, self.recording.model
        names, contacts = model.bodies.name, self.recording.contacts
        found = [f"{names[a['contact_body'][row]]}/{names[a['contact_other'][row]]}"
                 for row in np.flatnonzero(np.abs(contacts.tangential) > TOUCH).tolist()]
        return (*found, *(model.joints.name[j] for j in model.joints.frictional.tolist()
                          if abs(a["joint_friction"][0, j]) > TOUCH))

    def stiffness(self, body: str) -> PushResponse:
        """The stiffness of a body; its ``stiffness()`` is that along x, y and in rotation.

        Negative along the motion of an unstable equilibrium.

        Raises:
            SceneError: no body that moves freely; the stiffness is unknown.
        """
        model = self.recording.model
        known_body(self.recording.mechanism, body)
        if self.untold:
            raise SceneError([Problem("no-rest",
                                      f"stiffness is not defined with {self.untold}", "body")])
        number = model.names.body[body]
        spec = self.recording.mechanism.bodies[number]
        size = reach_of(spec, centre_of(spec)) or self.size
        return Linearization(self.recording, 0, size).of(number, signed=True)

    @property
    def frequency(self) -> float:
        """Of the slowest oscillation of a stable equilibrium [Hz]; nan without one."""
        if self.stability != STABLE or not (len(self.modes) and self.modes[0] > 0):
            return float("nan")
        return float(np.sqrt(self.modes[0]) / (2 * np.pi))


@dataclass(frozen=True)
class RestFound:
    """Equilibria of a scene."""

    rests: tuple[AtRest, ...]  #: different equilibria, in the order in which they were found
    failed: tuple[tuple[str, str], ...]  #: starts that did not come to rest, and the reasons
    remarks: tuple[str, ...]  #: how the scene was read


def rest(
    scene: Runnable, *, at: float | None = None, starts: Sequence[Start] = (),
    stages: int | None = None,
) -> RestFound:
    """Find static equilibria of a scene and their stability.

    Without ``starts`` the drives go slowly from their values at t = 0 to those at ``at``, from the
    scene's own pose: the equilibrium of a slow load. With ``starts``, each begins at its own pose,
    and the drives have their values at ``at``.

    Args:
        scene: a scene, a mechanism or what :func:`sandbox.load_scene` takes.
        at: the time whose values the drives have [s]; by default the end of the scene.
        starts: poses as mappings of ``JOINT.angle``, ``BODY.x``, ``BODY.y`` or ``BODY.angle`` to
            values in SI.
        stages: number of stages of the slow load; by default 40, with dry friction 200.

    Raises:
        SceneError: controllers, events at a time, nothing that moves freely, a start with unknown
            names; or no start that comes to rest, with the reasons.
    """
    mechanism = checked(scene, ())
    check_options(mechanism, at, stages)
    settler = Settler(mechanism, mechanism.run.duration if at is None else at)
    rests: list[AtRest] = []
    failed: list[tuple[str, str]] = []
    for start in starts or (None,):
        words = "" if start is None else " from " + ", ".join(
            f"{name} = {value:.6g}" for name, value in start.items())
        before = settler.steps
        try:
            if start is None:
                settler.follow(stages)
            else:
                settler.start(place_start(settler, start))
            found = settle(settler, words.removeprefix(" from "), before)
        except (Unsettled, SimulationDiverged) as error:
            failed.append((words, str(error) if isinstance(error, Unsettled)
                           else f"{error.culprit}: {error.reason}"))
            continue
        ways = [np.abs(found.recording.arrays["body_pose"] - one.recording.arrays["body_pose"])
                / (found.size, found.size, 1.0) for one in rests]
        if all(way.max() > SAME for way in ways):
            rests.append(found)
    if not rests:
        raise SceneError([Problem("no-rest", f"it does not come to rest{words}: {reason}", "rest",
                                  advice=settler.advice) for words, reason in failed])
    remarks = [f"the event {quoted(event.name)} is ignored: it depends on time"
               for event in mechanism.events if event.when is not None
               and (event.set or event.release or event.take_up)]
    return RestFound(tuple(rests), tuple(failed), (*remarks, *filter(None, [settler.remark])))


def settle(settler: Settler, start: str, before: int) -> AtRest:
    """The equilibrium near the present pose."""
    balance = settler.settle()
    untold = settler.untold
    if balance is None:
        settler.still.move(settler.drive, kept=True)
        untold = untold or "motions that Newton's method missed"
    run = settler.still.recording() if balance is None else balance.run
    return AtRest(run, start, balance, untold, settler.steps - before, settler.size)


def known_body(mechanism: Mechanism, body: str) -> None:
    """Refuse a name that is no body that moves freely, with a suggestion."""
    free = [each.name for each in mechanism.bodies if each.motion == "dynamic"]
    if body not in free:
        raise SceneError([Problem("name-not-found",
                                  f"{quoted(body)} is no body that moves freely", "body",
                                  allowed=listed(free), hint=near(body, free))])


def check_options(mechanism: Mechanism, at: float | None, stages: int | None) -> None:
    """Refuse what has no static equilibrium, times beyond the run, and too many stages."""
    run = mechanism.run
    found = [Problem(
        "no-rest", f"the controller {quoted(each.name)} needs time, and an equilibrium has none",
        f"$.controllers[{i}]", allowed="drives with the values that the controller reaches: remove "
                                       "the controller and set these")
        for i, each in enumerate(mechanism.controllers)]
    found += [Problem(
        "no-rest", f"the event {quoted(each.name)} acts at t = {each.at:g} s, and rest has no time",
        f"$.events[{mechanism.events.index(each)}]", allowed="a scene in which it has happened")
        for each in mechanism.events if each.at is not None and each.at <= run.duration
        and (each.set or each.release or each.take_up)]
    if at is not None and not 0 <= at <= run.duration:
        found.append(Problem("bad-time", f"{at:g} s is not within the run", "at",
                             allowed=f"0 to {run.duration:g} s"))
    if stages is not None and not 1 <= stages <= MAX_STAGES:
        found.append(Problem("bad-argument", f"{stages} is no number of stages", "stages",
                             allowed=f"1 to {MAX_STAGES}"))
    if found:
        raise SceneError(found)


def verdict(rest: AtRest) -> str:
    """The stability in words."""
    if rest.stability == UNSTABLE:
        grows = float(np.sqrt(-rest.modes[0]))
        return f"unstable: a small motion grows by the factor e every {1 / grows:.3g} s"
    if rest.stability == NEUTRAL:
        moves = ", ".join(rest.loose) or "some bodies"
        return f"neutral: nothing answers a small motion of {moves}"
    if rest.stability == UNKNOWN:
        return f"stability unknown with {rest.untold}"
    if not len(rest.modes):
        return "stable: nothing is free to move"
    return f"stable: lowest natural frequency {rest.frequency:.4g} Hz, without damping"


def quantities(run: Recording) -> dict[str, str]:
    """Names and units of the quantities that describe an equilibrium."""
    model, contacts = run.model, run.contacts
    hinged = set(model.joints.bodies[model.joints.hinges, 1].tolist())
    names = [*angles(model), *(f"{name}.length" for name in model.joints.name),
             *positions(model, hinged)]
    for of, parts in ((model.tendons, ["tension"]), (model.springs, ["force", "torque"]),
                      (model.lines, ["pressure"])):
        names += [f"{name}.{part}" for name in of.name for part in parts]
    for row, friction in enumerate(contacts.tangential.tolist()):
        pair = "/".join(model.bodies.name[each[row]] for each in (contacts.body, contacts.other))
        names += [f"{pair}.normal", *[f"{pair}.tangential"] * (abs(friction) > TOUCH)]
    return {name: run.unit(name) for name in names if name in run}


def places(run: Recording) -> list[str]:
    """Names of all angles of hinges and positions of bodies."""
    return [name for name in [*angles(run.model), *positions(run.model)] if name in run]
