"""Disc cams: the outline that gives a follower the lift of a table, as its envelope.

The follower moves along a line through the cam's centre. Seen from the cam it stands at the polar
angle psi, with the unit vector n towards it and t = dn/dpsi. With the lift s(psi) and the base
radius b:

- **flat**, a face across its way at b + s = h from the centre. The faces' envelope is
  x = h n + h' t, with the radius of curvature h + h''. Where that is not positive no cam touches
  the face there: undercut. So b > -min(s + s'').
- **roller** of radius r, whose centre goes along p = R n with R = b + r + s. The outline lies r
  inside of that pitch curve, x = p - r N with N = (R n - R' t) / sqrt(R^2 + R'^2). The pitch
  curve's curvature is (R^2 + 2 R'^2 - R R'') / (R^2 + R'^2)^(3/2). Where it is 1 / r or more, the
  outline would run back: undercut.

(Norton, *Cam Design and Manufacturing Handbook*, chapters 7 and 8.)
"""

from __future__ import annotations

import math
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from sandbox.numeric import Array
from sandbox.scene.outlines.curves import nodes_along
from sandbox.values.numbers import Angle, Coordinate, Items, Length, Point
from sandbox.values.spec import TYPE, Spec
from sandbox.values.tables import Spline
from sandbox.wording import WrongValueError, refuse_if

CHECKED = 3600  # angles at which undercut is checked, besides 8 between neighbours in the table
SPARE = 1e-3  # relative margin of the reported radius above the smallest possible one
FINE = 1e-9  # maximum distance of the outline's spans from the envelope [m]
SWINGS = 0.02
"""Share of the range of a lift by which a smooth peak between two entries may exceed them."""
LARGEST = 1e6  # the largest radius that is reported [m]


class DiscCam(Spec):
    """A disc cam whose outline gives its follower the lift of a table.

    Between the table's angles the lift is a periodic cubic spline. The follower moves along a line
    through the cam's centre. Contacts follow the true outline. It is read as a polygon with nodes.
    """

    type: Literal["cam"] = TYPE
    base: Length
    """Radius of the outline where the lift is 0."""
    lift: Annotated[Items[tuple[Angle, Coordinate]], Field(min_length=3, max_length=720)]
    """Rise of the follower by the cam's rotation: `[angle, lift]`, over less than a whole turn."""
    follower: Literal["roller", "flat"] = "roller"
    """Type of follower: a roller, or a flat face across its path."""
    roller: Length | None = None
    """Radius of the roller; for a roller only."""
    towards: Angle = math.pi / 2
    """Direction from the cam's centre to the follower, in the body's frame at its angle 0."""
    turns: Literal["counterclockwise", "clockwise"] = "counterclockwise"
    """Sense in which the table's angles count the cam's rotation."""
    at: Point = (0.0, 0.0)
    """Centre of rotation, in the body's frame."""
    tolerance: Length = 1e-5
    """Maximum deviation of chords in pictures and in its area; contacts do not depend on it."""

    def _verify(self) -> None:
        refuse_if(self.follower == "roller" and self.roller is None, "'roller' is missing (its "
                  "radius)", "missing-key", allowed="a 'roller', or '\"follower\": \"flat\"'")
        refuse_if(self.follower == "flat" and self.roller is not None, "a flat follower has no "
                  "'roller'", allowed="no 'roller', or '\"follower\": \"roller\"'")
        angles = [angle for angle, _ in self.lift]
        for i, (one, two) in enumerate(pairwise(angles)):
            refuse_if(two - one < 1e-6, f"the angles of 'lift' must increase: entry {i + 1} has "
                      f"{math.degrees(two):.6g} deg after {math.degrees(one):.6g} deg",
                      "bad-outline")
        turn = angles[-1] - angles[0]
        refuse_if(turn > math.tau - 1e-6, f"the angles of 'lift' cover {math.degrees(turn):.6g} "
                  "deg; plain numbers are radians", "bad-outline", allowed="less than a whole "
                  "turn, without the first entry again at its end; '15 deg' for degrees")

    @cached_property
    def rise(self) -> Spline:
        """The lift over the cam's turn [rad], periodic, [m]."""
        begin, height = self.lift[0]
        angles, lifts = np.array([*self.lift, (begin + math.tau, height)]).T
        return Spline(angles, lifts, "periodic")

    @property
    def sense(self) -> int:
        """1 for a cam that turns counter-clockwise, else -1."""
        return 1 if self.turns == "counterclockwise" else -1

    @cached_property
    def checked(self) -> Array:
        """Turns that lie close enough to see every bend of the lift [rad]."""
        ends = self.rise.at
        between = (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(8) / 8).ravel()
        return np.unique(np.concatenate([
            between, ends[0] + math.tau * np.arange(CHECKED) / CHECKED]))

    def contacts(self, turn: Array) -> Array:
        """Contact points with the follower at turns [rad], counter-clockwise, as nodes [n, 4]."""
        s, s1, s2 = self.rise(turn)
        s1 = -self.sense * s1  # over the direction of the follower as seen from the cam
        psi = self.towards - self.sense * turn
        n = np.stack([np.cos(psi), np.sin(psi)], axis=1)
        t = np.stack([-n[:, 1], n[:, 0]], axis=1)
        if self.roller is None:
            point, out = (self.base + s)[:, None] * n + s1[:, None] * t, n
            bend = 1 / (self.base + s + s2)
        else:
            r = self.base + self.roller + s
            speed = np.hypot(r, s1)
            out = (r[:, None] * n - s1[:, None] * t) / speed[:, None]
            point = r[:, None] * n - self.roller * out
            pitch = (r**2 + 2 * s1**2 - r * s2) / speed**3
            bend = pitch / (1 - self.roller * pitch)
        return np.column_stack([point, np.arctan2(out[:, 0], -out[:, 1]), bend])

    def radii(self) -> Array:
        """Radii of curvature at the turns :attr:`checked` [m], negative where it is undercut.

        Where the outline is hollow, its radius is below -r for a roller of radius r: no undercut.
        """
        with np.errstate(divide="ignore"):
            radius = np.asarray(1 / self.contacts(self.checked)[:, 3])
        return radius if self.roller is None else np.where(radius < -self.roller, LARGEST, radius)

    def swing(self) -> tuple[float, float, float] | None:
        """Lift [m], excess [m] and turn [rad] of a peak beyond all entries, if there is one."""
        lift, entries = self.rise(self.checked)[0], self.rise.pieces[:, 0]
        beyond = np.maximum(lift - entries.max(), entries.min() - lift)
        k = int(beyond.argmax())
        if beyond[k] <= SWINGS * np.ptp(entries):
            return None
        return float(lift[k]), float(beyond[k]), float(self.checked[k])

    def curve(self) -> Array:
        """Nodes of the outline about the cam's centre [n, 4], counter-clockwise.

        One lies at every angle of the lift's table.
        """
        lowest = float(self.rise(self.checked)[0].min())
        refuse_if(self.base + lowest <= 0, "the curve through the entries of 'lift' goes down to "
                  f"{lowest:.6g} m, below the cam's centre", "bad-outline", allowed="a base radius "
                  f"above {-lowest:.6g} m, or more entries where the curve swings between them")
        radii = self.radii()
        if radii.min() <= 0:
            turn = math.degrees(float(self.checked[int(radii.argmin())]))
            low, high = self.base, LARGEST
            while high - low > SPARE * low:
                middle = math.sqrt(low * high)
                fits = self.model_copy(update={"base": middle}).radii().min() > 0
                low, high = (low, middle) if fits else (middle, high)
            digit = 10.0 ** (math.floor(math.log10(high)) - 2)  # rounded up to three
            what, more = ("a flat follower bridges it", "") if self.roller is None else (
                f"a roller of {self.roller:.6g} m cannot reach it", ", or a smaller roller")
            raise WrongValueError(
                "bad-outline", f"this cam is undercut at a turn of {turn:.4g} deg: {what}", allowed=
                f"a base radius of at least {math.ceil(high / digit) * digit:.6g} m{more}")
        turns = np.union1d(self.rise.at, self.rise.at[0] + math.tau * np.arange(24) / 24)
        turns = turns[np.append(np.diff(turns) > 1e-9, True)]  # the same angle, but for rounding
        return nodes_along(lambda at: self.contacts(-self.sense * at), np.sort(-self.sense * turns),
                           FINE)[:-1]
