"""The range of contact forces in one sample that mechanics allows.

With friction, or with more contacts than degrees of freedom, balance does not determine single
contact forces. The possible forces are a convex set: on every free body m a = sum F and I alpha =
sum M, with contacts that push within their friction cones (in the plane two straight lines, so that
nothing is approximated) and tendons that pull. A linear program gives the least and the largest of
each component over this set (:mod:`sandbox.mechanics.linear_program`). The recorded forces have to
lie between them.

The largest push on an object follows from the same program with one more unknown: a force along a
direction at the centre of mass of one body. Drives, springs and weights stay as they are. Beyond
the largest such force there is no balance at rest in this pose; below it something may move, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, SMALLEST_SCALE, NotComputed, Worst, check
from sandbox.audit.outlines import touched
from sandbox.audit.unknowns import Unknown, Unknowns
from sandbox.mechanics.linear_program import LinearProgram
from sandbox.model.supports import RANK, components
from sandbox.numeric import Array

MANY = 60
"""Contacts at the end above which the audit leaves their bounds out."""
MOST = 300
"""Largest number of connected rows of balance, three a body."""


class Interval(NamedTuple):
    """A component of a contact force and its range [N]."""

    force: float
    low: float
    """-inf without a bound; nan where no forces balance."""
    high: float
    allowed: tuple[float, float]
    """Rounding error of either bound."""

    @property
    def excess(self) -> tuple[float, float]:
        """Distance below the least and above the largest [N]; 0 inside."""
        return _beyond(self.low - self.force), _beyond(self.force - self.high)

    @property
    def outside(self) -> bool:
        """Whether it exceeds rounding."""
        return any(off > most for off, most in zip(self.excess, self.allowed, strict=True))


def _beyond(off: float) -> float:
    return np.inf if np.isnan(off) else max(off, 0.0)


class Bounds(NamedTuple):
    """The ranges of one contact row."""

    row: int
    """Of the sample; contacts without a force have higher numbers."""
    body: int
    other: int
    normal: Interval
    tangential: Interval


def contact_bounds(
    evidence: Evidence, sample: int = -1, near: float | None = None,
) -> list[Bounds]:
    """Bounds of all contact rows in one sample of a recording, then of contacts without a force.

    ``near`` [m] is the distance within which outlines count as touching, by default the gap that a
    step may leave. Groups of more than :data:`MOST` rows are left out.

    Raises:
        ArithmeticError: a linear program does not converge.
    """
    allowed = evidence.left_allowed
    alone = touched(evidence.alone(sample % len(evidence.run), near))
    unknowns = Unknowns(alone)
    found = [bounds for group in together(unknowns) if 3 * len(group.bodies) <= MOST
             for bounds in Balance(unknowns, group, allowed).bounds()]
    return sorted(found)


class Together(NamedTuple):
    """Free bodies, and all unknown forces that act on them."""

    bodies: list[int]
    forces: list[Unknown]


def together(unknowns: Unknowns) -> list[Together]:
    """Groups with contacts; forces that act on the same free body are connected."""
    pairs = [(first, body) for first, *others in (list(one.does) for one in unknowns.all)
             for body in others]
    free = unknowns.model.bodies.free
    group = components(len(free), pairs)
    found: dict[int, Together] = {}
    for one in unknowns.all:
        found.setdefault(group[next(iter(one.does))], Together([], [])).forces.append(one)
    for body in np.flatnonzero(free).tolist():
        if group[body] in found:
            found[group[body]].bodies.append(body)
    return [each for each in found.values() if any(one.contact >= 0 for one in each.forces)]


class Balance:
    """The balance of a group as a linear program: forces of either sign are eliminated.

    W f = target on all bodies, moments over a length, so that all are forces. With F the columns of
    the free forces and N a basis of all motions on which these do no work, N^T F = 0, the others
    have N^T G x = N^T target.
    """

    def __init__(self, unknowns: Unknowns, group: Together, allowed: Array) -> None:
        self.unknowns, self.group = unknowns, group
        place = {body: 3 * i for i, body in enumerate(group.bodies)}
        W = np.zeros((3 * len(group.bodies), len(group.forces)))
        for k, one in enumerate(group.forces):
            for body, wrench in one.does.items():
                W[place[body]:place[body] + 3, k] += wrench
        force = np.hypot(W[0::3], W[1::3])
        arms = np.abs(W[2::3][force > 0])
        self.length = max(float(arms.max(initial=0.0)), 1e-6)
        scale = np.tile([1.0, 1.0, 1 / self.length], len(group.bodies))
        target = scale * unknowns.target[group.bodies].ravel()
        self.allowed = scale * np.stack(
            [allowed[0], allowed[0], allowed[1]], axis=1)[group.bodies].ravel()
        W *= scale[:, None]
        self.unit = np.maximum(np.linalg.norm(W, axis=0), 1e-300)
        """Unit of every force, by which it is of the order of 1."""
        W /= self.unit
        self.size = max(float(np.abs(target).max(initial=0.0)), self._largest(), SMALLEST_SCALE)
        free = np.array([one.free and np.isinf(one.most) for one in group.forces])
        self.free, self.F, self.G = free, W[:, free], W[:, ~free]
        self.target = target / self.size
        self._reduce()

    def _largest(self) -> float:
        """The largest recorded contact force [N], the unit of all forces."""
        rows = {one.contact for one in self.group.forces if one.contact >= 0}
        return max(float(np.hypot(*self.unknowns.arrays["contact_force"][row])) for row in rows)

    def _reduce(self) -> None:
        left, values, _ = np.linalg.svd(self.F)
        rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
        motions = left[:, rank:]
        limited = [k for k, one in enumerate(np.array(self.group.forces, dtype=object)[~self.free])
                   if np.isfinite(one.most)]
        # a force limited either way is p - q with p + q + rest = most
        self.limited = limited
        G = np.concatenate([self.G, -self.G[:, limited]], axis=1)
        left, values, _ = np.linalg.svd(motions.T @ G)
        rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
        self.motions = motions @ left[:, :rank]
        """Virtual motions on which the one-sided forces work, [rows, m]."""
        idle = motions @ left[:, rank:]
        self.idle = np.abs(self.target @ idle), np.abs(idle).T @ self.allowed / self.size
        n, k = G.shape[1], len(limited)
        A = np.zeros((rank + k, n + k))
        A[:rank, :n] = self.motions.T @ G
        for row, place in enumerate(limited):
            A[rank + row, [place, self.G.shape[1] + row, n + row]] = 1.0
        chosen = np.flatnonzero(~self.free)[limited]
        most = np.array([self.group.forces[i].most * self.unit[i] for i in chosen]) / self.size
        self.most = most
        self.program = LinearProgram(A, np.concatenate([self.motions.T @ self.target, most]))

    def bounds(self) -> Iterator[Bounds]:
        """The bounds of every contact row of the group."""
        a, contacts = self.unknowns.arrays, self.unknowns.evidence.run.contacts
        balanced = self.balanced()
        for row in sorted({one.contact for one in self.group.forces if one.contact >= 0}):
            parts = []
            for name in ("normal", "tangential"):
                weight = np.array([getattr(one, name) if one.contact == row else 0.0
                                   for one in self.group.forces]) / self.unit
                force = float(getattr(contacts, name)[row])
                if not balanced:
                    parts.append(Interval(force, np.nan, np.nan, (0.0, 0.0)))
                    continue
                (low, below), (high, above) = self.least(weight), self.least(-weight)
                parts.append(Interval(force, low, 0.0 - high, (below, above)))
            yield Bounds(row, int(a["contact_body"][row]), int(a["contact_other"][row]), *parts)

    def balanced(self) -> bool:
        """Whether there are forces that balance the sample, to rounding."""
        program, m = self.program, self.motions.shape[1]
        against = np.abs(self.motions @ program.against[:m]) @ self.allowed / self.size
        against += np.abs(program.against[m:]) @ (EXACT * self.most) + EXACT
        return bool(program.missing <= against and (self.idle[0] <= self.idle[1] + EXACT).all())

    def least(self, weight: Array) -> tuple[float, float]:
        """The least weighted sum of all forces [N], and its rounding error.

        Forces that balance up to d, and are negative by e at most, have a sum of at least
        y (target + d) - (c - G^T y) e.
        """
        scale = float(np.abs(weight).max())
        if scale == 0.0:  # no friction
            return 0.0, EXACT * self.size
        c, n = weight / scale, self.G.shape[1]
        joined = np.zeros(len(self.target))
        if c[self.free].any():
            joined = np.linalg.lstsq(self.F.T, c[self.free], rcond=None)[0]
        if np.abs(self.F.T @ joined - c[self.free]).max(initial=0.0) > RANK:
            return -np.inf, 0.0
        rest = c[~self.free] - joined @ self.G
        found = self.program.least(np.concatenate(
            [rest, -rest[self.limited], np.zeros(len(self.limited))]))
        if np.isinf(found.value):
            return -np.inf, 0.0
        m = self.motions.shape[1]
        y = joined + self.motions @ found.prices[:m]
        below = np.array([one.below for one in self.group.forces])[~self.free] * self.unit[
            ~self.free]
        slack = np.abs(y) @ self.allowed + np.maximum(found.reduced[:n], 0.0) @ below
        slack += self.size * float(np.abs(found.prices) @ np.abs(
            self.program.b - self._wanted())) + EXACT * self.size * (1 + float(np.abs(y).sum()))
        return (scale * self.size * (float(joined @ self.target) + found.value),
                scale * float(slack))

    def _wanted(self) -> Array:
        return np.concatenate([self.motions.T @ self.target, self.most])


@check("contact.bounds", "N", "minimum and maximum f with m a = Σ F, |t| <= μ n",
       asks="is each contact force within the range that balance and friction allow?",
       compared="distance of contact forces at the end from the range that balance and friction "
                "allow, {count:component}, worst: {where}{note}",
       none=f"more than {MOST // 3} bodies are connected")
def _contact_bounds(evidence: Evidence, worst: Worst) -> str:
    if not len(evidence.last.run.contacts.normal):
        raise NotComputed("nothing touches at the end")
    if len(evidence.last.run.contacts.normal) > MANY:
        raise NotComputed(f"more than {MANY} contacts at the end, which take minutes; "
                          "`sandbox bounds RUN` computes their ranges")
    widest, note, names = 0.0, "", evidence.model.bodies.name
    for bounds in contact_bounds(evidence):
        for kind, part in (("normal", bounds.normal), ("tangential", bounds.tangential)):
            label = f"{names[bounds.body]}/{names[bounds.other]}.{kind}"
            worst.add(label, np.array(part.excess), np.maximum(part.allowed, ROUNDING))
            if part.high - part.low > widest and kind == "normal":
                widest = part.high - part.low
                note = f"; widest: {label}, {part.force:.4g} in {part.low:.4g} to {part.high:.4g} N"
    return note


def push_limits(
    evidence: Evidence, body: int, directions: Sequence[float], sample: int = -1,
) -> Array:
    """The largest push of a body that balance, friction and unilateral contact allow [N].

    The push acts at the centre of mass, in each direction [rad]. inf where there is no bound; nan
    where no forces balance the sample itself; 0 for a body that nothing touches, and within the
    rounding error.

    Raises:
        ArithmeticError: a linear program fails.
    """
    (unknowns, group), found = _coupled(evidence, body, sample), []
    if group is None:
        return np.zeros(len(directions))
    for angle in directions:
        push = Unknown({body: np.array([np.cos(angle), np.sin(angle), 0.0])})
        balance = Balance(unknowns, Together(group.bodies, [*group.forces, push]),
                          evidence.left_allowed)
        weight = np.zeros(len(group.forces) + 1)
        weight[-1] = -1.0 / balance.unit[-1]
        least, slack = balance.least(weight) if balance.balanced() else (np.nan, 0.0)
        found.append(0.0 if abs(least) <= slack else -least)
    return np.array(found)


def _coupled(evidence: Evidence, body: int, sample: int) -> tuple[Unknowns, Together | None]:
    """All unknown forces of a sample, and those coupled to a body; None if nothing touches it."""
    unknowns = Unknowns(touched(evidence.alone(sample % len(evidence.run))))
    return unknowns, next((each for each in together(unknowns) if body in each.bodies), None)
