"""Bodies between two pins, and what they carry from one to the other. Nothing here draws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array
from sandbox.picture.run_data import RunData

XY = tuple[float, float]
SAME = 1e-9
"""Pins of a body that are no farther apart are one [m]."""


class PinnedBar(NamedTuple):
    """A body with pins in two places."""

    body: int
    ends: tuple[XY, XY]
    """In its frame [m]."""
    joints: tuple[tuple[int, ...], tuple[int, ...]]
    """Those at either end."""


def bars_of(run: RunData, bodies: Sequence[int]) -> list[PinnedBar]:
    """Those of ``bodies`` that move and that pins hold in exactly two places."""
    joints = run.model.joints
    found: dict[int, list[tuple[XY, list[int]]]] = {}
    for k, kind in enumerate(joints.kind):
        for end in (0, 1) if kind.keeps == "point" else ():
            x, y = (float(v) for v in joints.anchor[k, end])
            places = found.setdefault(int(joints.bodies[k, end]), [])
            near = next((each for at, each in places
                         if abs(at[0] - x) + abs(at[1] - y) <= SAME), None)
            if near is None:
                places.append(((x, y), [k]))
            else:
                near.append(k)
    wanted = {body for body in bodies if not run.model.bodies.fixed[body]}
    return [PinnedBar(body, (one[0], two[0]), (tuple(one[1]), tuple(two[1])))
            for body, (one, two) in sorted((body, places) for body, places in found.items()
                                           if len(places) == 2 and body in wanted)]


def bar_tensions(run: RunData, bars: Sequence[PinnedBar]) -> Array:
    """The pull that each bar carries from pin to pin [N], negative where it pushes, [n, k].

    With the forces F of the pins on the bar and u from one to the other it is (F2 - F1) . u / 2:
    the tension where nothing else loads the bar, else the mean of that at either end.
    """
    force, angle = run.arrays["joint_force"], run.arrays["body_pose"][..., 2]
    tension = np.zeros((len(angle), len(bars)))
    for k, bar in enumerate(bars):
        (x0, y0), (x1, y1) = bar.ends
        way = angle[:, bar.body] + np.arctan2(y1 - y0, x1 - x0)
        on_start, on_end = (_on(run, bar.body, joints, force) for joints in bar.joints)
        carried = on_end - on_start
        tension[:, k] = (carried[:, 0] * np.cos(way) + carried[:, 1] * np.sin(way)) / 2
    return np.nan_to_num(tension)


def _on(run: RunData, body: int, joints: Sequence[int], force: Array) -> Array:
    """What these joints push a body with [N], [n, 2]."""
    total = np.zeros((len(force), 2))
    for k in joints:
        total += force[:, k] if run.model.joints.bodies[k, 1] == body else -force[:, k]
    return total
