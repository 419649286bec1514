"""What changes of a picture from sample to sample: poses and values, as columns of numbers.

A frame of the replay and of the live view holds the same: ``t``, ``pose`` of all bodies,
``contacts``, ``patches`` and, by these names, the rows of :func:`channels`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from sandbox.elements.arrays import Arrays, largest_size
from sandbox.model.joints import link_tensions
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.picture.bars import bar_tensions, bars_of
from sandbox.picture.elements.cords import slipping
from sandbox.picture.elements.forces import Vectors, accelerations, reactions, velocities
from sandbox.picture.elements.pressure import FlatSides
from sandbox.picture.marked import marked
from sandbox.picture.run_data import RunData
from sandbox.samples.contacts import contacts_on
from sandbox.samples.cords import piece_tensions
from sandbox.scene.layers import EVERY, meant
from sandbox.scene.mechanism import Mechanism
from sandbox.show.drives import limited
from sandbox.show.lines import shown_pieces

STEADY = ("load", "stop", "held", "lifted", "sticks", "slip", "pressure", "flow")
"""Channels that have between two samples what they have in the nearest; others go over evenly."""


class SomeSamples(NamedTuple):
    """Some samples as pictures take them."""

    mechanism: Mechanism
    model: Model
    arrays: Arrays
    time: Array


def vectors_of(run: RunData) -> dict[str, tuple[str, Vectors]]:
    """Arrows that are shown on wish: by the name of their channel the layer, and what they show."""
    places = marked(run, run.mechanism.view, EVERY)
    every = range(len(run.mechanism.bodies))
    return {"moving": ("velocity", velocities(run, places)),
            "gaining": ("acceleration", accelerations(run, places)),
            "hinged": ("reactions", reactions(run, every))}


def sides_of(run: RunData, shown: tuple[Integers, Array] | None = None) -> FlatSides:
    """The flat sides that touch of the bodies of which the view shows pressure, of all if of none.

    ``shown`` as :class:`FlatSides` takes it.
    """
    patterns = run.mechanism.view.show.get("pressure") or EVERY
    return FlatSides(run, meant(patterns, run.mechanism.bodies), shown)


def patch_rows(sides: FlatSides, samples: Integers) -> Array:
    """What touches along a line: both ends x, y [m], each with the force per length [N/m], [k, 7].

    Out of the body that it acts on is to the left, from the first end to the second; the last
    column is the place in ``samples``.
    """
    patches, places = sides.patches(samples)
    rows = [(*a, q0, *b, q1) if (b[0] - a[0]) * way[1] > (b[1] - a[1]) * way[0]
            else (*b, q1, *a, q0) for a, b, q0, q1, way in patches]
    found = np.column_stack([np.array(rows).reshape(len(rows), 6), places])
    return found[np.any(found[:, [2, 5]] > 0, axis=1)]  # not what presses in one point


def moving(model: Model) -> Integers:
    """Numbers of the bodies whose poses are kept."""
    return np.flatnonzero(~model.bodies.fixed)


def channels(
    model: Model, arrays: Arrays, link: Array | None = None, *, wished: bool = True,
) -> dict[str, Array]:
    """Of ``n`` samples each channel [n, columns], those without columns left out.

    ``pose`` x, y [m], angle [rad] of each moving body; ``drive`` values; ``tension`` of cords'
    pieces and ``link`` of joints [N], negative where one pushes; ``stop`` -1, 0 or 1; ``held``,
    ``lifted``, ``sticks`` and ``slip`` 0 or 1; ``pressure`` [Pa]; ``flow`` through valves, its
    sign; ``given`` by drives [N m, N]; ``way`` of surfaces that run, counter-clockwise [m];
    ``load`` fx, fy [N] and torque [N m] of each load; ``bars`` what bodies between two pins carry
    [N]; two columns for each arrow of :func:`vectors_of`.

    Args:
        model: the mechanism's.
        arrays: of a recording, or of one sample.
        link: tensions of joints [n, nj], where they are known already.
        wished: whether those that are shown on wish are among them, ``bars`` and the arrows.
    """
    n = len(arrays["time"])
    pieces = np.concatenate([np.zeros(0, np.int64), *shown_pieces(model)])
    stop = arrays["joint_stop"]
    least = 1e-4 * largest_size(stop)
    rubbed = model.joints.rubbed
    found: Mapping[str, Array] = {
        "pose": arrays["body_pose"][:, moving(model)].reshape(n, -1),
        "drive": arrays["drive_value"],
        "tension": piece_tensions(model, arrays, pieces).T,
        "link": _links(model, arrays) if link is None else link,
        "stop": np.where(np.abs(stop) > least, np.sign(stop), 0.0)[:, model.joints.stopped],
        "held": arrays["held"],
        "lifted": arrays["guide_lifted"],
        "sticks": arrays["joint_sticks"][:, rubbed],
        "slip": slipping(arrays["guide_slip"]).astype(float),
        "pressure": arrays["line_pressure"],
        "flow": np.sign(arrays["valve_flow"]),
        "given": arrays["drive_torque"][:, limited(model)],
        "way": surface_ways(model, arrays),
        "load": np.concatenate([arrays["load_force"], arrays["load_torque"][..., None]],
                               axis=2).reshape(n, -1),
    }
    if wished:
        found = {**found, **_wished(SomeSamples(model.mechanism, model, arrays, arrays["time"]))}
    return {name: np.asarray(rows, float) for name, rows in found.items() if rows.shape[1]}


def _wished(some: SomeSamples) -> dict[str, Array]:
    bars = bars_of(some, range(len(some.model.bodies.name)))
    arrows = {name: np.nan_to_num(vectors.values).reshape(len(some.time), -1)
              for name, (_, vectors) in vectors_of(some).items()}
    return {
        "bars": bar_tensions(some, bars),
        **arrows,
    }


def _links(model: Model, arrays: Arrays) -> Array:
    """Tensions of rods and ropes [n, nj]; 0 of other joints, no columns where there are none."""
    lines = np.array([k for k, kind in enumerate(model.joints.kind)
                      if "tension" in kind.records], np.int64)
    result = np.zeros((len(arrays["time"]), len(model.joints.name) if len(lines) else 0))
    if len(lines):
        result[:, lines] = np.nan_to_num(link_tensions(model, arrays, lines))
    return result


def surface_ways(model: Model, arrays: Arrays) -> Array:
    """How far each surface that runs has come, counter-clockwise round its body [m], [n, k]."""
    drives = model.drives
    which = drives.giving("surface")
    steps = np.diff(arrays["time"], prepend=0.0)[:, None]
    speed = np.nan_to_num(drives.sense[which]) * arrays["drive_value"][:, which]
    return np.asarray(np.cumsum(steps * speed, axis=0))


def touching_pairs(model: Model, arrays: Arrays) -> tuple[Integers, Integers]:
    """The pairs of bodies that touch at any time, [k, 2], and of every row of contacts its pair."""
    count = len(model.bodies.name)
    keys, which = np.unique(arrays["contact_body"] * count + arrays["contact_other"],
                            return_inverse=True)
    return np.stack((keys // count, keys % count), axis=1), which


def contact_rows(model: Model, arrays: Arrays, some: Integers | slice = slice(None)) -> Array:
    """Of some rows where [m], the force [N] and the bodies: it is shown on the first, [m, 6]."""
    on, force = contacts_on(model, arrays)
    other = arrays["contact_body"] + arrays["contact_other"] - on
    return np.column_stack([arrays["contact_point"][some], force[some], on[some], other[some]])
