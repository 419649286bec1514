"""Stiffness of a grasp: the response of bodies to a small push, from one recorded sample.

All free bodies move by a small q that keeps the constraints (joints, pressing contacts, stops,
motors that hold a position): A q = 0, with rows A that are the wrenches of unit forces. All else
has a stiffness K: springs and tendons k u u^T for the wrench u of a unit effort; every force its
geometric stiffness lambda du/dq. At a contact the radii of both sides move the contact point.
Balance in the allowed motions Z, Z^T K Z z = Z^T w, gives the response Z z to a push w.

A sliding contact constrains the normal alone, and its friction is mu times the normal force: then
the forces B differ from the rows A, and their null space from Z.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sandbox.elements.arrays import CONTACT, LAYOUT, PER_SAMPLE
from sandbox.model.joints import rotated
from sandbox.model.model import NONE, Model, held_of
from sandbox.model.pairs import friction_of, pair_skins
from sandbox.model.supports import components, turning_row
from sandbox.numeric import Array
from sandbox.samples.contacts import TOUCH, slip_speeds
from sandbox.samples.loads import Batch, Loads
from sandbox.samples.nearby import pressed

if TYPE_CHECKING:
    from sandbox.samples.samples import Samples

RANK = 1e-9  # Directions with a smaller share than this are rounding
SMALL = 1e-7  # Motions [m, and by the size of the object rad] of central differences
NOTHING = 1e-6  # Minimum stiffness over that of the order of the geometric one, force / size
NEAR = 1e-8  # Distance [m] from a contact's plane, besides motion in a step, where corners press
AT_CONE = 1e-6  # Distance of friction from its limit, relative to it, that counts as 0
SLIDES = 1e-6  # Least speed of sliding [m/s]
SOFTLY = 1e-6  # Least component of an object in a motion without stiffness


class Elastic(NamedTuple):
    """An element with a stiffness."""

    kind: str  # ``spring``, ``tendon`` or ``drive``
    number: int  # Of the element among its kind
    stiffness: float  # [N/m, N m/rad]
    pull: Array  # Wrench of its unit force on all free bodies, [3 n]


class PushResponse(NamedTuple):
    """The response of a body to a small push at its centre of mass."""

    compliance: Array
    """Its motion (x, y, turn) by force (x, y) and couple [m/N, rad/N, rad/(N m)], [3, 3]; 0 where
    it is held rigidly."""
    loose: Array  # Which of (x, y, turn) have no stiffness, [3] of bool
    free: Array  # The directions (x, y) without stiffness, [k, 2]
    signed: bool = False  # Whether instability is a negative stiffness, not 0

    def stiffness(self) -> Array:
        """Force along x over motion along x, the same of y and turn, the least of (x, y), [4].

        0 without stiffness, inf for a rigid body; negative, if ``signed``, where unstable.
        """
        along = [0.0 if loose or (c < 0 and not self.signed) else np.inf if c == 0 else 1 / c
                 for loose, c in zip(self.loose, np.diag(self.compliance), strict=True)]
        low, high = np.linalg.eigvalsh((self.compliance + self.compliance.T)[:2, :2] / 2)
        if len(self.free) or (low < -RANK * abs(high) and not self.signed):
            return np.array([*along, 0.0])
        steep = low if low < -RANK * abs(high) and high >= 0 else high
        return np.array([*along, np.inf if steep == 0 else 1 / steep])


def without_stiffness(model: Model) -> str:
    """Elements whose stiffness one sample does not determine, in words; empty without them."""
    if pair_skins(model.mechanism).size:
        return "soft skin"
    return ("fluids" if model.lines.name else "loads by laws" if model.loads.name else "teeth"
            if any(kind.teeth for kind in model.joints.kind) else "")


class Rigid(NamedTuple):
    """A force between two bodies that keeps them from moving along it."""

    bodies: tuple[int, int]
    arms: Array
    """From the centres of mass to the centre of rounding of either side, or a point, [2, 2]."""
    radii: tuple[float, float]
    along: Array  # Direction of the force on the first body, [2]
    turns: int  # The line turns with body 0 or 1, with the line between both points (2), or not (3)
    force: float = 0.0  # Magnitude [N]
    across: bool = False  # Whether it acts across that line, as friction does
    holds: bool = True  # Whether it is a constraint; else only its geometric stiffness counts
    friction: float = 0.0  # Ratio of the next force to this one, of a contact that slides


class Linearization:
    """The free bodies of a recording in one of its samples."""

    def __init__(self, run: Samples, sample: int, size: float) -> None:
        """``size`` is the length [m] equivalent to a rotation of 1 rad."""
        self.run, self.model, self.sample, self.size = run, run.model, sample, size
        free = np.flatnonzero(self.model.bodies.free)
        self._at = np.full(len(self.model.bodies.name), NONE)  # first row of each body
        self._at[free] = 3 * np.arange(len(free))
        self.count = 3 * len(free)
        self.steps = SMALL * np.tile([size, size, 1.0], len(free))
        each = np.arange(self.count)
        moved = np.zeros((2 * self.count + 1, len(self._at), 3))
        moved[1 + each, free[each // 3], each % 3] = self.steps
        moved[1 + self.count + each, free[each // 3], each % 3] = -self.steps
        self.loads = Loads(_repeated(run, sample, moved))
        """At rest, then with each freedom moved by a step forwards, then with each backwards."""
        self.centre = self.loads.frames.centre[:2, :, 0].T
        turned = np.zeros((self.count, 2 * self.count))  # of loads of constant magnitude
        for batch in self.loads.batches:
            on = self._at[batch.body] >= 0
            np.add.at(turned, self._at[batch.body[on], None] + np.arange(3),
                      batch.wrench[on, :, 1:])
        self.stiffness = np.asarray(
            (turned[:, self.count:] - turned[:, :self.count]) / (2 * self.steps))
        self.stiffness += sum((one.stiffness * np.outer(one.pull, one.pull)
                               for one in self.elastic()), np.zeros_like(self.stiffness))
        self.largest = max((float(np.hypot(*batch.wrench[:, :2, 0].T).max(initial=0.0))
                            for batch in self.loads.batches), default=0.0)
        self._engaged = held_of(self.model.bonds.joint, run.arrays["held"])[:, sample]
        rigids = [one for j in np.flatnonzero(self._engaged).tolist() for one in self._joint(j)]
        for row in np.flatnonzero(run.arrays["contact_sample"] == sample).tolist():
            rigids += self._touch(row)
        rows, held = self._rigid_rows(rigids), list(self._fixed())
        self.kept = held + [rows[i] for i, one in enumerate(rigids) if one.holds]
        """Rows of the constraints, each [3 n]."""
        self.pushes = held + [rows[i] + (one.friction * rows[i + 1] if one.friction else 0.0)
                              for i, one in enumerate(rigids) if one.holds]
        """Forces of the constraints; they differ from the rows at sliding contacts."""

    def _rows(self, efforts: Batch, count: int) -> Array:
        """Wrenches of unit efforts of ``count`` elements on all free bodies, [count, 3 n]."""
        found = efforts.wrenches(count, len(self._at))
        return found[:, self._at >= 0].reshape(count, self.count)

    def elastic(self) -> Iterator[Elastic]:
        """Elastic elements: springs, taut tendons, servos with a stiffness."""
        a, model, s = self.run.arrays, self.model, self.sample
        springs, tendons = model.springs, model.tendons
        taut = np.flatnonzero((tendons.drive == NONE) & (a["tendon_tension"][s] > 0)).tolist()
        for kind, own, drive, which, efforts in (
                ("spring", springs.stiffness, springs.drive, range(len(springs.name)),
                 self.loads.spring_efforts),
                ("tendon", tendons.stiffness, tendons.stiffener, taut, self.loads.cable_efforts)):
            rows = self._rows(efforts, len(own))
            for i in which:
                k = float(own[i] if drive[i] == NONE else a["drive_value"][s, drive[i]])
                if kind == "spring" and (law := springs.law[i]) is not None:
                    stretch = float(a["spring_length"][s, i] - springs.rest[i])
                    step = 1e-5 * max(abs(stretch), 1e-3)
                    k = float(law.slopes(stretch + np.array([-step, step]), k)[0])
                yield Elastic(kind, i, k, rows[i])
        for i, u in self._placing():
            if np.isfinite(model.drives.stiffness[i]):
                yield Elastic("drive", i, float(model.drives.stiffness[i]), u)

    def _placing(self) -> Iterator[tuple[int, Array]]:
        """Drives that hold a position or a speed below their limit."""
        drives, a, s = self.model.drives, self.run.arrays, self.sample
        efforts = self._rows(self.loads.drive_efforts, len(drives.name))
        for i, kind in enumerate(drives.kind):
            if not kind.limited or np.isfinite(drives.slope[i]):
                continue
            if abs(a["drive_torque"][s, i]) < self.loads.limits[i, 0] * (1 - AT_CONE):
                yield i, efforts[i]

    def _fixed(self) -> Iterator[Array]:
        """Rows of drives, stops and friction that hold, and of joints that do not turn."""
        a, joints, s = self.run.arrays, self.model.joints, self.sample
        yield from (u for i, u in self._placing()
                    if not np.isfinite(self.model.drives.stiffness[i]))
        stopped = joints.stopped[a["joint_stop"][s, joints.stopped] != 0.0]
        stuck = joints.frictional[a["joint_sticks"][s, joints.frictional] == 1.0]
        for efforts, held in ((self.loads.joint_efforts, stopped),
                              (self.loads.friction_efforts, stuck)):
            yield from self._rows(efforts, len(joints.name))[held]
        for j in np.flatnonzero(self._engaged & ~joints.turns).tolist():
            yield turning_row(self.model, j)[0, self._at >= 0].ravel()

    def _rigid_rows(self, rigids: Sequence[Rigid]) -> Array:
        """The rows of forces of joints and contacts, [k, 3 n]; adds their geometric stiffness."""
        found = np.zeros((len(rigids), self.count))
        if not rigids:
            return found
        bodies, arms, radii, along, turns, forces, across, *_ = map(
            np.array, zip(*rigids, strict=True))
        # central differences of wrenches by the motions x, y, angle of both bodies
        steps = SMALL * np.array([self.size, self.size, 1.0] * 2)
        moved = np.concatenate([np.zeros((1, 6)), np.diag(steps), -np.diag(steps)])
        at = [self.centre[bodies[:, None, k]] + moved[:, 3 * k:3 * k + 2] for k in (0, 1)]
        ends = [at[k] + rotated(arms[:, None, k], moved[:, 3 * k + 2]) for k in (0, 1)]
        way = ends[0] - ends[1]
        n = np.broadcast_to(along[:, None], way.shape).copy()
        between = turns == 2
        n[between] = way[between] / np.hypot(way[between, :, :1], way[between, :, 1:])
        for k in (0, 1):
            n[turns == k] = rotated(along[turns == k, None], moved[:, 3 * k + 2])
        point = np.where(turns[:, None, None] == 0, ends[1] + radii[:, None, 1:] * n,
                         ends[0] - radii[:, None, :1] * n)
        f = np.where(across[:, None, None], np.stack([-n[..., 1], n[..., 0]], axis=-1), n)
        moments = [(point - at[k])[..., 0] * f[..., 1] - (point - at[k])[..., 1] * f[..., 0]
                   for k in (0, 1)]
        wrenches = np.concatenate([f, moments[0][..., None], -f, -moments[1][..., None]], axis=-1)
        slopes = ((wrenches[:, 1:7] - wrenches[:, 7:]) / (2 * steps[:, None])).transpose(0, 2, 1)
        self.largest = max(self.largest, float(np.abs(forces).max()))
        for i, places in enumerate(self._at[bodies]):
            on = np.repeat(places >= 0, 3)
            rows = (places[:, None] + np.arange(3)).ravel()[on]
            found[i, rows] = wrenches[i, 0, on]
            self.stiffness[np.ix_(rows, rows)] -= forces[i] * slopes[i][np.ix_(on, on)]
        return found

    def _joint(self, j: int) -> Iterator[Rigid]:
        """The possible forces of a joint on ``b``."""
        joints, frames = self.model.joints, self.loads.frames
        a, b = joints.bodies[j].tolist()
        f = self.run.arrays["joint_force"][self.sample, j]
        ends = [np.array([end.x[j, 0], end.y[j, 0]]) for end in reversed(frames.anchors)]
        arms = np.array([ends[0] - self.centre[b], ends[1] - self.centre[a]])

        def rigid(along: Array, turns: int, radius: float = 0.0, *, across: bool = False) -> Rigid:
            way = np.array([-along[1], along[0]]) if across else along
            return Rigid((b, a), arms, (radius, 0.0), along, turns, float(f @ way), across)

        keeps = joints.kind[j].keeps
        if keeps == "point":
            yield from (rigid(way, 3) for way in np.eye(2))
        elif keeps == "groove":
            place = frames.place_in_slot(j)
            x, y, bend = (float(v[0]) for v in (place.x, place.y, place.bend))
            friction = abs(float(np.nan_to_num(self.run.arrays["joint_friction"][self.sample, j])))
            if abs(float(f[0]) * x + float(f[1]) * y) > TOUCH + friction:  # an end pushes the point
                yield rigid(np.array([x, y]), 1)
            if bend == 0.0:
                yield rigid(np.array([-y, x]), 1)
                return
            way = np.array([y, -x]) / bend  # from the centre of curvature, as a rod
            arms = arms - np.array([np.zeros(2), way])
            yield rigid(way * abs(bend), 2)
        elif keeps in ("distance", "roll") or (keeps == "range" and np.hypot(*f) > TOUCH):
            way = ends[0] - ends[1]
            n = way / max(float(np.hypot(*way)), 1e-300)
            if keeps != "roll":
                yield rigid(n, 2)
                return
            radius = float(joints.radii[j, 1]) * (-1.0 if joints.inside[j] else 1.0)
            yield from (rigid(n, 2, radius, across=across) for across in (False, True))

    def _touch(self, row: int) -> Iterator[Rigid]:
        """The normal forces and the friction of a contact that presses."""
        a = self.run.arrays
        pair = int(a["contact_body"][row]), int(a["contact_other"][row])
        contacts = self.run.contacts
        normal, tangential = float(contacts.normal[row]), float(contacts.tangential[row])
        if normal <= TOUCH or not self.model.bodies.free[list(pair)].any():
            return
        mu = friction_of(self.run.mechanism, *pair)
        slides = abs(tangential) >= mu * normal * (1 - AT_CONE) and slip_speeds(
            a, np.array([row]))[0] > SLIDES
        for k, (share, rigid) in enumerate(self._points(row, pair)):
            yield rigid._replace(force=share * normal, friction=float(
                np.copysign(mu, tangential)) if slides else 0.0)
            yield rigid._replace(force=share * tangential, across=True,
                                 holds=bool(mu and k == 0 and not slides))

    def _points(self, row: int, pair: tuple[int, int]) -> list[tuple[float, Rigid]]:
        """Points of a contact: share of the force, and its normal force."""
        a, s, both = self.run.arrays, self.sample, list(pair)
        u, point = a["contact_normal"][row], a["contact_point"][row]
        near = NEAR + self.run.info.step * float(np.hypot(*a["body_velocity"][s, both, :2].T).sum())
        ends, (one, two) = pressed(self.run, row, near)
        near += abs(float(a["contact_gap"][row])) / 2
        if ends is None or one is None or two is None:
            raise ArithmeticError("bodies that touch with several normals")
        flat = [side.high - side.low > near for side in (one, two)]
        if len(ends) == 2:
            way = ends[1] - ends[0]
            second = min(max(float((point - ends[0]) @ way / (way @ way)), 0.0), 1.0)
            return [(share, Rigid(pair, at - self.centre[both], (0.0, 0.0), u, 1))
                    for share, at in zip((1 - second, second), ends, strict=True)
                    if share > AT_CONE]
        radii = (0.0 if flat[0] else one.radius, 0.0 if flat[1] else two.radius)
        if not any(flat) and sum(radii) <= near:
            raise ArithmeticError("corner on corner")
        arms = np.array([point + radii[0] * u, point - radii[1] * u]) - self.centre[both]
        return [(1.0, Rigid(pair, arms, radii, u, 0 if flat[0] else 1 if flat[1] else 2))]

    def of(self, body: int, *, signed: bool = False) -> PushResponse:
        """The response of a free body; ``signed`` as of :class:`PushResponse`."""
        kept, pushes = (np.array(rows).reshape(len(rows), self.count)
                        for rows in (self.kept, self.pushes))
        # degrees of freedom coupled to those of the body, and its own among them
        bodies = [np.abs(each).reshape(len(each), self.count // 3, 3).max(axis=2) > 0
                  for each in (kept, pushes, self.stiffness)]
        joins = bodies[0].T @ bodies[0] | bodies[1].T @ bodies[1] | (
            bodies[2].reshape(-1, 3, self.count // 3).any(axis=1))
        group, first = np.array(components(len(joins), np.argwhere(joins))), self._at[body] // 3
        reached = group == group[first]
        part = np.flatnonzero(np.repeat(reached, 3))
        own = 3 * int(reached[:first].sum()) + np.arange(3)
        scale = np.tile([1.0, 1.0, 1 / self.size], len(part) // 3)
        K = scale * self.stiffness[np.ix_(part, part)] * scale[:, None]
        symmetric = np.array_equal(kept, pushes)
        Z = null_space(kept[:, part] * scale)
        Y = Z if symmetric else null_space(pushes[:, part] * scale)
        if Z.shape != Y.shape:
            raise ArithmeticError("contacts that slide and jam")
        M, motions, forces = Y.T @ K @ Z, Z[own], Y[own]
        motions, forces = (np.where(np.abs(each) > RANK, each, 0.0) for each in (motions, forces))
        nothing = NOTHING * self.largest / self.size
        if symmetric:
            values, left = np.linalg.eigh((M + M.T) / 2)
            right = left
            soft = (np.abs(values) if signed else values) <= max(
                nothing, 1e-14 * np.abs(values).max(initial=0.0))
        else:
            left, values, rows = np.linalg.svd(M)
            right, soft = rows.T, values <= max(nothing, 1e-14 * values.max(initial=0.0))
        away = (motions @ right[:, soft]).T
        away = away[np.abs(away).max(axis=1, initial=0.0) > SOFTLY]
        firm = ~soft
        C = (motions @ right[:, firm] / values[firm]) @ (forces @ left[:, firm]).T
        back = np.array([1.0, 1.0, 1 / self.size])
        loose = np.abs(away).max(axis=0, initial=0.0) > SOFTLY
        free = away[np.abs(away[:, :2]).max(axis=1, initial=0.0) > SOFTLY, :2]
        return PushResponse(back * C * back[:, None], loose, free, signed)


def _repeated(run: Samples, sample: int, moved: Array) -> Samples:
    """Copies of one sample, without contacts, moved about the centres of mass by [k, nb, 3]."""
    which = np.full(len(moved), sample)
    arrays = {key: run.arrays[key][:0] if key in CONTACT else
              run.arrays[key][which] if key in PER_SAMPLE else run.arrays[key] for key in LAYOUT}
    pose, centre = np.array(arrays["body_pose"]), run.arrays["body_centre"]
    before = rotated(centre, pose[..., 2])
    pose += moved
    pose[..., :2] += before - rotated(centre, pose[..., 2])
    arrays["body_pose"] = pose
    return run.with_arrays(arrays)


def null_space(rows: Array) -> Array:
    """Orthonormal motions that leave all rows at 0, [n, k]."""
    size = np.linalg.norm(rows, axis=1)
    _, values, motions = np.linalg.svd(rows[size > 0] / size[size > 0, None])
    return np.asarray(motions[np.count_nonzero(values > RANK):].T)
