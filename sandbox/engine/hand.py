"""A hand that takes hold of a body and draws it to a place, as by a spring.

Force = k (place - point) - c velocity, critically damped for a mass m: k = m w^2, c = 2 m w, and
w = :data:`QUICK`. It is computed every T = :data:`EVERY` and constant in between: stable for a mass
m' at the point while w T m / m' < 1. So m is that of all connected bodies, but at most :data:`MOST`
times the effective mass of the body alone at the point.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.engine.live import Live
from sandbox.errors import Problem, SceneError
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.numeric import Array, connected_components
from sandbox.scene.played import Nudge
from sandbox.values.units import in_range
from sandbox.wording import WrongValueError

QUICK = 40.0
"""How fast it draws, w [1/s]: a tenth of the way is left after 0.1 s."""
EVERY = 4e-3
"""Time between two forces [s], a step at least."""
MOST = 5.0
"""Times the least mass that a point answers with: w T times this is 0.8."""
WEIGHTS = 50.0
"""The most that it draws with, in weights of what is joined to the body."""
FINE = 1e-6
"""Its force goes in steps of about this times the most: what holds still needs no new number."""
GRAVITY = 9.81  # [m/s^2]


class Hand:
    """One hand of a live run; ``force`` is what it draws with [N]."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.model: Model = compile_mechanism(live.scene)
        self.body: str | None = None
        """What it holds."""
        self.at = self.to = self.force = (0.0, 0.0)
        """The point in the body's frame, the place in the world [m], the force there [N]."""
        self._masses = _joined_masses(self.model)
        self._stiffness = self._damping = self._cap = 0.0
        self._digits = 0

    @property
    def every(self) -> int:
        """Steps between two forces; of steps that are too long for it each one."""
        return max(1, int(EVERY / self.live.scene.run.step + 1e-9))

    def hold(self, body: str, at: Sequence[float], to: Sequence[float]) -> None:
        """Take hold of a body at a point of its frame, to draw it to a place in the world [m]."""
        at, to = _place(at), _place(to)
        if (body, at) != (self.body, self.at):
            self.drop()
            self.live.push(body, at, (0.0, 0.0))  # what cannot be held is refused there
            index = self.model.names.body[body]
            bodies, whole = self.model.bodies, self._masses[index]
            arm = float(np.hypot(*(np.asarray(at, float) - bodies.centre[index])))
            alone = float(1 / (1 / bodies.mass[index] + arm**2 / bodies.inertia[index]))
            longest = max(EVERY, self.live.scene.run.step)
            # a step that is itself longer sees velocities half a step late
            mass = min(whole, MOST * alone * EVERY / (2 * longest - EVERY))
            self._stiffness, self._damping = mass * QUICK**2, 2 * mass * QUICK
            self._cap = WEIGHTS * GRAVITY * whole
            self._digits = -round(math.log10(FINE * self._cap))
            self.body, self.at = body, at
        self.to = to

    def drop(self) -> None:
        """Let go."""
        if self.body is not None and not self.live.finished:
            self.live.push(self.body, self.at, (0.0, 0.0))
        self.body, self.force = None, (0.0, 0.0)

    def let_go(self) -> None:
        """Let go what another hand held when the run was at this instant before."""
        last = next((each for each in reversed(self.live.inputs) if isinstance(each, Nudge)), None)
        if last is not None and any(last.force) and not self.live.finished:
            self.live.push(last.body, last.at, (0.0, 0.0))

    def draw(self) -> None:
        """Push as it has to now; to be called before every :attr:`every` steps."""
        if self.body is None:
            return
        (x, y), (vx, vy) = self.point()
        fx = self._stiffness * (self.to[0] - x) - self._damping * vx
        fy = self._stiffness * (self.to[1] - y) - self._damping * vy
        less = min(1.0, self._cap / max(math.hypot(fx, fy), 1e-300))
        self.force = round(less * fx, self._digits), round(less * fy, self._digits)
        self.live.push(self.body, self.at, self.force)

    def point(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Where the point is that it holds and how it moves [m, m/s]."""
        assert self.body is not None
        live, body = self.live, self.body
        x, y, angle, vx, vy, rate = (
            live[f"{body}.{name}"] for name in ("x", "y", "angle", "vx", "vy", "omega"))
        c, s = math.cos(angle), math.sin(angle)
        (ax, ay), (cx, cy) = self.at, self.model.bodies.centre[self.model.names.body[body]]
        rx, ry = c * (ax - cx) - s * (ay - cy), s * (ax - cx) + c * (ay - cy)
        return ((x + c * ax - s * ay, y + s * ax + c * ay),
                (vx - rate * ry, vy + rate * rx))

def _place(numbers: Sequence[float]) -> tuple[float, float]:
    """Two lengths [m]."""
    try:
        x, y = (in_range(float(number), "length") for number in numbers)
    except (TypeError, ValueError) as error:
        said = error.message if isinstance(error, WrongValueError) else "it has other numbers"
        allowed = error.allowed if isinstance(error, WrongValueError) else "two finite numbers"
        raise SceneError([Problem("bad-argument", f"{tuple(numbers)!r} is no place: {said}", "drag",
                                  allowed=allowed)]) from None
    return x, y


def _joined_masses(model: Model) -> Array:
    """For each body the total mass of the free bodies that joints connect with it, [nb]."""
    mass = np.where(np.isfinite(model.bodies.mass), model.bodies.mass, 0.0)
    pairs = model.joints.bodies[(mass[model.joints.bodies] > 0).all(axis=1)]
    links = np.zeros((len(mass), len(mass)), dtype=bool)
    links[*pairs.T] = links[*pairs[:, ::-1].T] = True
    total = np.zeros(len(mass))
    for group in connected_components(links):
        total[group] = mass[group].sum()
    return total
