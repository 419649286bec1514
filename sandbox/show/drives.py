"""Parts of drives and loads: arrows to scale, marks about hinges, running surfaces."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.model.model import Model
from sandbox.picture.elements.drives import DRIVES, drive_tie
from sandbox.picture.elements.drives import LENGTH as DRIVE_LENGTH
from sandbox.picture.elements.forces import LOAD_LENGTH, TELLING, load_scale
from sandbox.picture.geometry import shape_points
from sandbox.picture.points import PointPool
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import ForceScale, typical
from sandbox.show.drawing import ARROWS, reaches, told_drives
from sandbox.show.joints import tie_of
from sandbox.show.points import Part, path, point, short


def belts(run: RunData) -> Iterator[Part]:
    """Marks along outlines that run; ``w`` is the column of ``way``."""
    drives = run.model.drives
    for column, drive in enumerate(drives.giving("surface").tolist()):
        body = int(drives.target[drive])
        for shape in run.mechanism.bodies[body].shapes:
            points = shape_points(shape)
            yield {"k": "belt", "l": "drives", "n": drives.name[drive], "b": body, "w": column,
                   "d": drive, "sense": int(drives.sense[drive]),
                   "r": path(np.vstack([points, points[:1]]))}


def drive_marks(run: RunData) -> Iterator[Part]:
    """Squares of brakes, arcs of motors, dials of servos."""
    model = run.model
    for k, drive in enumerate(run.mechanism.drives):
        kind = DRIVES[drive.type].mark
        if kind:
            joint = int(model.drives.target[k])
            yield {"k": kind, "l": "drives", "n": drive.name, "d": k,
                   "at": point(model.joints.bodies[joint, 1], model.joints.anchor[joint, 1]),
                   "sense": int(model.joints.sense[joint])}


def arrows(run: RunData, scale: ForceScale, width: float) -> Iterator[Part]:
    """Forces, pulls and torques from outside.

    ``to`` are two points that the arrow points along, ``dir`` a direction besides; ``bend`` is the
    sense of one about a hinge. ``scaled`` ones go by the scale of the contact forces, others are
    ``long`` at their largest value.
    """
    model, pool = run.model, PointPool()
    made = [(k, drive, ARROWS[drive.type](model, k, pool))
            for k, drive in enumerate(run.mechanism.drives) if drive.type in ARROWS]
    pool.close()
    for k, drive, arrow in made:
        sizes = np.abs(run.arrays["drive_value"][:, k])
        usual = typical(sizes, run.time)
        yield {"k": "drive", "l": "drives", "n": drive.name, "d": k,
               "unit": model.drives.kind[k].unit, "at": point(*pool.place(arrow.at)),
               "to": [point(*pool.place(i)) for i in arrow.line],
               "dir": [short(v) for v in arrow.direction], "bend": arrow.bent,
               "radius": short(arrow.radius), "most": short(sizes.max(initial=0.0)),
               "usual": short(usual), "scaled": reaches(arrow, usual, scale),
               "long": short(DRIVE_LENGTH * width),
               **tie_of(drive_tie(model, k))}


def told_parts(run: RunData) -> Iterator[Part]:
    """What motors, brakes, servos and actuators give, where they are few; ``c`` of ``given``."""
    pool = PointPool()
    told = told_drives(run, pool)
    pool.close()
    columns = {k: c for c, k in enumerate(limited(run.model))}
    for one in told:
        yield {"k": "told", "l": "drives", "n": one.name, "c": columns[one.number],
               "unit": one.unit, "at": [point(*pool.place(i)) for i in one.ends],
               "decimals": one.decimals}


def limited(model: Model) -> list[int]:
    """Drives whose torque or force the solve works out, the columns of ``given``."""
    return [k for k, kind in enumerate(model.drives.kind) if kind.limited]


def load_parts(run: RunData, scale: ForceScale, width: float) -> list[Part]:
    """Arrows of loads: one part for all, with the places and names of each."""
    loads = run.model.loads
    if not loads.name:
        return []
    own = load_scale(run, LOAD_LENGTH * width, scale)
    return [{"k": "loads", "l": "loads", "unit": "N", "metres": short(own.metres),
             "longest": short(own.longest) if math.isfinite(own.longest) else 0.0,
             "most": short(own.reference), "told": len(loads.name) <= TELLING,
             "at": [point(body, at) for body, at in zip(loads.body, loads.at, strict=True)],
             "lifts": [law is None for law in loads.law],
             "names": [run.mechanism.loads[int(i)].name for i in loads.load]}]
