"""From a pose to rest: the drives as they are or slowly followed, relaxed, then polished."""

from __future__ import annotations

import numpy as np

from sandbox.engine.still import Still
from sandbox.equilibria.balance import PoseBalance
from sandbox.equilibria.polish import look, polish
from sandbox.equilibria.relax import TURNS, Relaxation
from sandbox.errors import Problem, SceneError
from sandbox.model.friction import friction_of
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.samples.yielding import without_stiffness
from sandbox.scene.geometry import centre_of, reach_of
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import quoted

STAGES, ROUGH_STAGES = 40, 200
"""In which drives go from their first values to their last, a slow load; the second where there is
dry friction, which remembers the way."""
STEPS = 20_000
"""Of one relaxation, at most."""
NEAR = (1e-7, 1e-9)
"""Shares of the size: what comes no farther in a step from rest may be near enough to polish."""
BALANCED = 1e-9
"""Of the largest force: what may be left of all forces along free motions."""
CLOSE = 1e-6
"""The same where Newton's method does not settle, by rounding or where something just touches."""
WAY = 0.02
"""Of the size: the farthest that a point goes in a step; no farther than half the distance at
which contacts are seen coming."""
PLACE = {"x", "y", "angle"}
"""What the law of a load reads if it pulls back: a drag does not."""
PUSHED = 4e-5
"""How far scheduled bodies go at once [m]: the engine undoes an overlap at 0.1 m/s."""


class Unsettled(Exception):
    """A start that did not come to rest; the text says why."""


class Search:
    """Equilibria of one mechanism with its drives as they are at a time.

    Args:
        mechanism: what is to rest.
        time: of the values of its drives, and of places of scheduled bodies [s].

    Raises:
        SceneError: nothing moves freely; as a :class:`~sandbox.engine.simulation.Simulation`.
    """

    def __init__(self, mechanism: Mechanism, time: float) -> None:
        self.still, self.time = Still(mechanism), time
        self.model: Model = self.still.model
        if not self.model.bodies.free.any():
            raise SceneError([Problem("no-rest",
                                      "nothing moves freely: there is nothing to come to rest",
                                      "bodies")])
        self.first = self.still.pose
        """Where the scene has all bodies, [nb, 3]."""
        self.reach = _reach(self.model)
        self.size = _size(self.model, self.first, self.reach)
        self.most = min(self.still.margin / 2, WAY * self.size)
        self.drive, self.places = self.still.driven(time)
        self.relaxation = Relaxation(self.still, self.size, self.reach, self.most)
        self.lost = ""
        """What is to be known of a slow load that led through no rest."""
        self.rough = has_friction(self.model)
        """Whether rest hangs on the way there."""
        self.untold = no_stiffness(self.model)
        """Why stiffness, and with it stability, is not told; empty if it is."""

    def follow(self, stages: int | None = None) -> None:
        """Let the drives go slowly to their values at the time, from the scene's own pose.

        Args:
            stages: in how many, all at rest; by default more where there is dry friction.

        Raises:
            SimulationDiverged: the motion stopped being finite.
        """
        self.still.put(self.first)
        stages = stages or (ROUGH_STAGES if self.rough else STAGES)
        times = np.linspace(0.0, self.time, stages + 1)
        last: Array | None = None
        for time in times:
            drive, places = self.still.driven(float(time))
            if last is not None and np.array_equal(last, drive) and not self._off(places):
                continue
            self._push_on(places, drive)
            done = self.relaxation.run(drive, steps=STEPS // 4, rest=NEAR[0])
            if not done.at_rest and not self.lost and time < self.time:
                self.lost = (f"with the drives as at t = {time:.3g} s it does not come to rest, "
                             f"{self._why(done.worst, drive)}: how it goes on from there is not "
                             "told by a slow load alone")
            last = drive

    def start(self, pose: Array) -> None:
        """Begin with the free bodies of a pose where it has them, with drives as at the time."""
        begin = np.where(self.model.bodies.free[:, None], pose, self.first)
        begin[self.still.scheduled] = self.places
        self.still.put(begin)

    def settle(self) -> PoseBalance | None:
        """Come to rest from where the bodies are; None where stiffness is not told.

        Raises:
            Unsettled: it does not.
            SimulationDiverged: the motion stopped being finite.
        """
        for near in NEAR if not self.untold else ():
            self._relax(near)
            pose = self.still.pose
            try:
                found = self.polished()
            except ArithmeticError as error:
                self.untold = str(error)
                break
            if found is not None and found.stable:
                return found
            self.still.put(pose)
        self._relax(None)
        if self.untold:
            return None
        return self.polished() or self._near()

    def _near(self) -> PoseBalance | None:
        """What holds where a relaxation ended, if it is as good as balanced."""
        balance = self.look()
        left = np.abs(balance.left).max(initial=0.0)
        return balance if left <= CLOSE * balance.largest else None

    def polished(self) -> PoseBalance | None:
        """Newton's method from where the bodies are; None if it leads nowhere near."""
        pose = self.still.pose
        found = polish(self.still, self.drive, self.size, most=self.most)
        balance = found.balance
        left = np.abs(balance.left).max(initial=0.0)
        if found.exact and left <= BALANCED * max(balance.largest, 1e-9):
            return balance
        self.still.put(pose)
        return None

    def look(self) -> PoseBalance:
        """What holds where the bodies are."""
        return look(self.still, self.drive, self.size)

    def _relax(self, near: float | None) -> None:
        more = {} if near is None else {"rest": near}
        done = self.relaxation.run(self.drive, steps=STEPS, **more)
        if not done.at_rest:
            raise Unsettled(self._why(done.worst, self.drive))

    def _why(self, worst: int, drive: Array) -> str:
        """Why it does not come to rest."""
        drives = self.model.drives
        rates = [drives.name[i] for i, kind in enumerate(drives.kind)
                 if kind.unit in ("rad/s", "m/s") and drive[i] != 0]
        name = quoted(self.model.bodies.name[worst])
        moved = (self.still.pose - self.first)[worst]
        way = float(np.hypot(*moved[:2]))
        if rates:
            return f"the drive {quoted(rates[0])} goes on for ever, and {name} with it"
        if way > self.size:
            return f"nothing holds {name}: it has gone {way:.3g} m and goes on"
        if abs(moved[2]) > TURNS:
            return f"nothing holds {name}: it turns on and on"
        return f"{name} still moves after {self.relaxation.moved} steps"

    def _off(self, places: Array) -> bool:
        return bool(np.any(self.still.pose[self.still.scheduled] != places))

    def _push_on(self, places: Array, drive: Array) -> None:
        """Bring scheduled bodies to their places, little by little."""
        on = self.still.scheduled
        if not len(on):
            return
        begin = self.still.pose[on]
        way = places - begin
        far = np.abs(way[:, :2]).sum(axis=1) + self.reach[on] * np.abs(way[:, 2])
        count = int(np.ceil(far.max(initial=0.0) / PUSHED))
        for k in range(1, count + 1):
            pose = self.still.pose
            moved = pose + self.still.step_size * self.still.speed
            moved[on] = begin + way * k / count
            self.still.put(moved)
            self.still.move(drive)
        if count:
            pose = self.still.pose
            pose[on] = places
            self.still.put(pose)


def has_friction(model: Model) -> bool:
    """Whether anything that may touch or slide has dry friction."""
    tendons, bodies = model.tendons, model.mechanism.bodies
    shaped = [i for i, body in enumerate(bodies) if body.shapes]
    return bool(
        len(model.joints.rubbed)
        or any(len(tendons.gripped(cord)) for cord in range(len(tendons.name)))
        or any(friction_of(model.mechanism, i, k) > 0 for i in shaped for k in shaped
               if i < k and (model.bodies.free[i] or model.bodies.free[k])))


def no_stiffness(model: Model) -> str:
    """Why no stiffness is told of a mechanism, in words; empty if it is."""
    tendons = model.tendons
    if any(len(tendons.gripped(cord)) for cord in range(len(tendons.name))):
        return "cords with friction in their guides"
    why = without_stiffness(model)
    if why == "loads by laws" and not any(
            law is None or law.names & PLACE for law in model.loads.law):
        return "teeth" if any(kind.teeth for kind in model.joints.kind) else ""
    return why


def _reach(model: Model) -> Array:
    """Of every body: how far any point of it is from its centre of mass, [nb] m."""
    found = np.array([reach_of(body, centre_of(body)) if body.motion == "dynamic"
                      else reach_of(body, (0.0, 0.0)) for body in model.mechanism.bodies])
    centre, tendons = model.bodies.centre, model.tendons
    points = [(model.joints.bodies.reshape(-1), model.joints.anchor.reshape(-1, 2)),
              (model.springs.bodies.reshape(-1), model.springs.anchor.reshape(-1, 2)),
              (tendons.guide_body, tendons.guide_at)]
    for bodies, at in points:
        far = np.nan_to_num(np.hypot(*(at - centre[bodies]).T))
        np.maximum.at(found, bodies, far)
    return found


def _size(model: Model, pose: Array, reach: Array) -> float:
    """Of the mechanism: the largest extent of what moves [m]."""
    free = model.bodies.free
    low = (pose[free, :2] - reach[free, None]).min(axis=0)
    high = (pose[free, :2] + reach[free, None]).max(axis=0)
    return float(max((high - low).max(), 1e-6))
