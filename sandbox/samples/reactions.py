"""Joint reactions as vectors, from the balance of every body; no solver's number is used.

With c the centre of mass, F the recorded loads of a body (tendons, springs,
drives, contacts, weight, ...) and R the forces of its joints at arms r,

    m a = sum F + sum R,    I alpha = sum M + sum r x R

for every sample: equations (32), (33) without the change of frame. What has a
single unknown joint gives its reaction; known reactions then count as loads on
the bodies at their other ends, from the tips of every tree inward. A body with
several joints of at most three unknowns together (ropes and rods pull along a
known line, a slot presses across its groove) is solved as a small system. What
is left are loops, solved all at once by least squares. Where the equations do
not decide, the reaction is nan and a reason is given.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from sandbox.numeric import Array, Flags
from sandbox.samples.loads import Loads
from sandbox.samples.stored import Stored

MOST = 48
"""Unknowns of a loop that are still solved for."""
END = 1e-9
"""So near the end of its groove [m] a slot may also push along it."""
FLAT = 1e-9
"""Least singular value of a loop's equations, against the largest, that still decides."""
SINGLE, SMALL, LOOP = "single", "small", "loop"


@dataclass
class Reactions:
    """What every joint does to its body ``b``, and what of the balance is left over."""

    force: Array
    """In the world [N], [2, nj, n]; nan where it is not determined."""
    couple: Array
    """Of welds and sliders that do not turn [N m], [nj, n]; 0 for others."""
    left: Array
    """Loads and reactions less m a, and moments less I alpha, [3, nb, n]."""
    how: dict[int, str] = field(default_factory=dict)
    """Of each joint: ``single``, ``small``, ``loop``; not in it if not determined."""
    why: dict[int, str] = field(default_factory=dict)
    """Of each joint that is not determined, the reason."""
    open: Flags = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))
    """Joints and samples in which a determined joint is not, [nj, n]."""

    doubt: Flags = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))
    """Bodies and samples whose moments are not all known, [nb, n]."""


def joint_reactions(run: Stored) -> Array:
    """Force of every joint on its body ``b``, in the world [N], shape [n, nj, 2].

    nan where the balance of the bodies does not decide it.
    """
    return np.ascontiguousarray(solve(Loads(run)).force.transpose(2, 1, 0))


def solve(loads: Loads) -> Reactions:
    """The reactions of all joints in all samples."""
    return _Solver(loads).solve()


Column = tuple[Array, Array, Array]
"""Force x, y and moment about the centre of mass of a unit of an unknown, on ``b``, [n] each."""


class _Solver:
    def __init__(self, loads: Loads) -> None:
        self.loads, self.frames = loads, loads.frames
        self.joints, free = loads.model.joints, loads.model.bodies.free
        self.unknowns: list[int] = self.joints.unknowns.tolist()
        count, n = len(self.joints.name), loads.frames.samples
        a = loads.run.arrays
        inertia = np.stack([a["body_mass"], a["body_mass"], a["body_inertia"]])[:, :, None]
        inertia = np.where(free[:, None], inertia, 0.0)
        left = loads.totals - inertia * self.frames.acceleration
        self.result = Reactions(np.full((2, count, n), np.nan), np.zeros((count, n)), left,
                                doubt=loads.spread.copy(), open=np.zeros((count, n), dtype=bool))
        self.tainted = np.zeros((len(free), n), dtype=bool)
        """Bodies and samples with a load that is not known, from a joint further out."""
        self.open: dict[int, list[int]] = {int(b): [] for b in np.flatnonzero(free)}
        for joint, pair in enumerate(self.joints.bodies):
            held = [int(body) for body in pair if int(body) in self.open]
            for body in held:
                self.open[body].append(joint)
            if not held:
                self.result.why[joint] = "neither of its bodies moves freely"

    def solve(self) -> Reactions:
        """Bodies with one unknown joint first, then small systems, loops last."""
        for most, step in ((1, self._single), (3, self._small)):
            while body := self._next(most):
                step(body[0])
                if most > 1:
                    while one := self._next(1):
                        self._single(one[0])
        for bodies in self._clusters():
            self._loop(bodies)
        return self.result

    def _next(self, most: int) -> list[int]:
        """A body whose unknown joints are one, or have so many unknowns at most."""
        for body, joints in self.open.items():
            if not joints:
                continue
            if len(joints) == 1 or (
                most > 1 and sum(self.unknowns[j] for j in joints) <= most
            ):
                return [body]
        return []

    # -- the three ways -----------------------------------------------------------------

    def _single(self, body: int) -> None:
        """One unknown joint: the balance of forces is its reaction."""
        joint = self.open[body][0]
        self.result.open[joint] = self.tainted[body]
        side = self._side(joint, body)
        left = self.result.left[:, body]
        if self.joints.kind[joint].along_line:
            ux, uy = self._line(joint)
            along = -side * (left[0] * ux + left[1] * uy)
            force = np.stack([along * ux, along * uy])
        else:
            force = -side * left[:2]
        couple = np.zeros(left.shape[1])
        if not self.joints.turns[joint]:
            ax, ay = self._arm(joint, body)
            couple = -side * (left[2] + side * (ax * force[1] - ay * force[0]))
        self._give(joint, force, couple, SINGLE, body)

    def _small(self, body: int) -> None:
        """At most three unknowns on one body: a 3 x 3 system in every sample."""
        unknowns = [(joint, column) for joint in self.open[body]
                    for column in self._columns(joint, body)]
        scale = self._reach(body)
        columns = [np.stack([c[0], c[1], c[2] / scale]) for _, c in unknowns]
        left = self.result.left[:, body] / np.array([1.0, 1.0, scale])[:, None]
        found = _three(columns, -left)
        unsure = self._at_an_end(body) | self.tainted[body]
        if self.joints.turns[self.open[body]].all():
            unsure = unsure | self.result.doubt[body]  # moments decide forces here
        # columns in line with each other, of numbers that are sound
        unsure = unsure | (np.isnan(found[0]) & np.isfinite(left).all(axis=0))
        self._give_all(self.open[body].copy(), found, SMALL, body, unsure)

    def _loop(self, bodies: list[int]) -> None:
        """Bodies in a ring: all their unknowns by least squares, sample by sample."""
        joints = sorted({joint for body in bodies for joint in self.open[body]})
        sizes = [self.unknowns[joint] for joint in joints]
        count, first = sum(sizes), np.cumsum([0, *sizes])
        if count > min(MOST, 3 * len(bodies)):
            reason = ("its ring has more unknown forces than equations"
                      if count > 3 * len(bodies) else f"its ring has more than {MOST} unknowns")
            self._give_up(joints, reason)
            return
        n = self.frames.samples
        A, f = np.zeros((n, 3 * len(bodies), count)), np.zeros((n, 3 * len(bodies)))
        for row, body in enumerate(bodies):
            scale = np.array([1.0, 1.0, 1.0 / self._reach(body)])
            f[:, 3 * row:3 * row + 3] = -(self.result.left[:, body].T * scale)
            for joint in self.open[body]:
                at = first[joints.index(joint)]
                for k, column in enumerate(self._columns(joint, body)):
                    A[:, 3 * row:3 * row + 3, at + k] = np.stack(column, axis=1) * scale
        if not _decides(A):
            self._give_up(joints, "its ring does not decide it: supports that share a load")
            return
        AT = A.transpose(0, 2, 1)
        x = np.linalg.solve(AT @ A, AT @ f[:, :, None])[:, :, 0]
        # once more, on what is left over: what squaring the equations costs in digits
        x += np.linalg.solve(AT @ A, AT @ (f[:, :, None] - A @ x[:, :, None]))[:, :, 0]
        unsure = np.any([self.result.doubt[body] | self._at_an_end(body) | self.tainted[body]
                         for body in bodies], axis=0)
        self._give_all(joints, list(x.T), LOOP, unsure=unsure)

    def _at_an_end(self, body: int) -> Flags:
        """Samples in which a slot of the body may be at an end of its groove, [n]."""
        result = np.zeros(self.frames.samples, dtype=bool)
        for joint in self.open[body]:
            if not self._slides(joint):
                continue
            a, start = self.joints.bodies[joint, 0], self.joints.groove[joint, 0]
            place = self.frames.anchors[1]
            dx, dy = place.x[joint] - self.frames.x[a], place.y[joint] - self.frames.y[a]
            c, s = self.frames.cos[a], self.frames.sin[a]
            gx, gy = self.joints.groove[joint, 1] - start
            length = float(np.hypot(gx, gy))
            along = ((c * dx + s * dy - start[0]) * gx + (c * dy - s * dx - start[1]) * gy) / length
            result |= (along < END) | (along > length - END)
        return result

    # -- joints ---------------------------------------------------------------------------

    def _side(self, joint: int, body: int) -> float:
        """+1 where ``body`` is the joint's ``b``, -1 where it is ``a``."""
        return 1.0 if self.joints.bodies[joint, 1] == body else -1.0

    def _slides(self, joint: int) -> bool:
        """Whether it keeps a point of ``b`` in a groove of ``a``."""
        return self.joints.kind[joint].keeps == "groove"

    def _arm(self, joint: int, body: int) -> tuple[Array, Array]:
        """From the body's centre of mass to where the joint holds it."""
        a, b = self.frames.anchors
        at = b if self._side(joint, body) > 0 or self._slides(joint) else a
        if at is b and self._side(joint, body) < 0:  # the groove's body is held where the pin is
            return b.x[joint] - self.frames.centre_x[body], b.y[joint] - self.frames.centre_y[body]
        return at.arm_x[joint], at.arm_y[joint]

    def _line(self, joint: int) -> tuple[Array, Array]:
        """Unit vector from the anchor on ``a`` to that on ``b``; of a slot, across its groove."""
        if self._slides(joint):
            dx, dy = self.joints.groove[joint, 1] - self.joints.groove[joint, 0]
            nx, ny = -dy / np.hypot(dx, dy), dx / np.hypot(dx, dy)
            a = self.joints.bodies[joint, 0]
            c, s = self.frames.cos[a], self.frames.sin[a]
            return c * nx - s * ny, s * nx + c * ny
        a, b = self.frames.anchors
        dx, dy = b.x[joint] - a.x[joint], b.y[joint] - a.y[joint]
        length = np.maximum(np.hypot(dx, dy), 1e-300)
        return dx / length, dy / length

    def _columns(self, joint: int, body: int) -> list[Column]:
        """What a unit of each of the joint's unknowns does to ``body``."""
        side = self._side(joint, body)
        ax, ay = self._arm(joint, body)
        one, none = np.full_like(ax, side), np.zeros_like(ax)
        found: list[Column] = []
        if self.joints.kind[joint].forces == 2:
            found += [(one, none, -side * ay), (none, one, side * ax)]
        else:
            ux, uy = self._line(joint)
            found.append((side * ux, side * uy, side * (ax * uy - ay * ux)))
        if not self.joints.turns[joint]:
            found.append((none, none, one))
        return found

    def _reach(self, body: int) -> float:
        """A length of the body [m], to weigh moments against forces; the same in every sample."""
        centre = self.loads.run.arrays["body_centre"][body]
        points: list[Array] = []
        for joint in self.open[body]:
            if self._side(joint, body) > 0:
                points.append(self.joints.anchor[joint, 1])
            elif self._slides(joint):
                points += [*self.joints.groove[joint]]
            else:
                points.append(self.joints.anchor[joint, 0])
        return max((math.dist(point, centre) for point in points), default=0.0) or 1.0

    # -- handing on -------------------------------------------------------------------------

    def _give_all(
        self, joints: list[int], found: list[Array], how: str, source: int = -1,
        unsure: Flags | None = None,
    ) -> None:
        """Turn unknowns, in the joints' order, into reactions; nan in samples ``unsure``."""
        at = 0
        if unsure is not None and unsure.any():
            found = [np.where(unsure, np.nan, one) for one in found]
            self.result.open[joints] = unsure
        for joint in joints:
            if self.joints.kind[joint].forces == 2:
                force = np.stack(found[at:at + 2])
                at += 2
            else:
                ux, uy = self._line(joint)
                force = np.stack([found[at] * ux, found[at] * uy])
                at += 1
            couple = np.zeros(force.shape[1])
            if not self.joints.turns[joint]:
                couple = found[at]
                at += 1
            self._give(joint, force, couple, how, source)

    def _give(
        self, joint: int, force: Array, couple: Array, how: str, source: int = -1,
    ) -> None:
        """Keep a reaction, and count it as a load on both of its bodies.

        A couple that came from moments in doubt leaves the other body's in doubt, too.
        """
        result = self.result
        result.force[:, joint], result.couple[joint], result.how[joint] = force, couple, how
        pair = self.joints.bodies[joint]
        self.tainted[pair] |= result.open[joint]
        if source >= 0 and not self.joints.turns[joint]:
            result.doubt[pair] |= result.doubt[source]
        for body in pair:
            if int(body) not in self.open:
                continue
            side = self._side(joint, body)
            ax, ay = self._arm(joint, body)
            result.left[0, body] += side * force[0]
            result.left[1, body] += side * force[1]
            result.left[2, body] += side * (ax * force[1] - ay * force[0] + couple)
            self.open[int(body)].remove(joint)

    def _give_up(self, joints: list[int], reason: str) -> None:
        for joint in joints:
            self.result.why[joint] = reason
            for body in self.joints.bodies[joint]:
                if joint in self.open.get(int(body), ()):
                    self.open[int(body)].remove(joint)

    def _clusters(self) -> list[list[int]]:
        """Bodies that still have unknown joints, gathered where they share one."""
        waiting = [body for body, joints in self.open.items() if joints]
        clusters: list[list[int]] = []
        while waiting:
            cluster = [waiting.pop()]
            for body in cluster:
                joined = {b for b in waiting if set(self.open[b]) & set(self.open[body])}
                cluster += sorted(joined)
                waiting = [b for b in waiting if b not in joined]
            clusters.append(sorted(cluster))
        return clusters


def _three(columns: list[Array], f: Array) -> list[Array]:
    """Least squares for one to three unknowns with columns [3, n] and right side f [3, n].

    Columns that are missing are made up at right angles to those given; what f
    has along them is what is left over. nan where columns are in line.
    """
    count = len(columns)
    given = [np.ascontiguousarray(column) for column in columns]
    while len(given) < 3:
        given.append(_cross3(given[0], given[1]) if len(given) == 2 else _across(given[0]))
    a, b, c = given
    planes = _cross3(b, c), _cross3(c, a), _cross3(a, b)
    volume = _dot3(a, planes[0])
    size = np.sqrt(_dot3(a, a) * _dot3(b, b) * _dot3(c, c))
    volume = np.where(np.abs(volume) > FLAT * size, volume, np.nan)
    return [_dot3(plane, f) / volume for plane in planes[:count]]


def _cross3(p: Array, q: Array) -> Array:
    return np.stack([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                     p[0] * q[1] - p[1] * q[0]])


def _dot3(p: Array, q: Array) -> Array:
    return np.asarray(p[0] * q[0] + p[1] * q[1] + p[2] * q[2])


def _across(p: Array) -> Array:
    """Some vector at right angles to p, [3, n]."""
    flat = np.abs(p[2]) < np.hypot(p[0], p[1])
    return np.where(flat, np.stack([-p[1], p[0], np.zeros_like(p[0])]),
                    np.stack([np.zeros_like(p[0]), -p[2], p[1]]))


def _decides(A: Array) -> bool:
    """Whether a few samples of A [n, rows, columns] all have full rank."""
    few = A[np.linspace(0, len(A) - 1, min(len(A), 8)).astype(int)]
    if not len(few):
        return True
    values = np.linalg.svd(few, compute_uv=False)
    return bool((values[:, -1] > FLAT * values[:, 0]).all())


