"""What all figures of an audit are drawn from, each part worked out once."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.loads import Loads
from sandbox.samples.samples import Samples

SAMPLES = 200
"""About so many samples, evenly spread to the last, are compared where each costs time."""
NUMBERS = 4_000_000
"""Bodies times samples that are kept at a time; longer runs are thinned to it."""


OVERLAP = 1e-6
"""An overlap [m] that recordings of bodies at rest may show; of older ones it is left for good."""


class Evidence:
    """A recording, its loads and reactions, and how exact they can be.

    ``shift`` is the root of most tolerances of lengths. The solver takes contacts
    apart again by moving bodies, a fifth of what they overlap beyond that each
    step: by a quarter of the overlap that is left, and at the far end of a
    light body by up to four times that. Forces know of it: those of tendons,
    springs and drives belong to the pose before (``Loads.aimed``).
    """

    def __init__(self, run: Samples) -> None:
        self.whole, self.model = run, run.model
        stride = max(1, -(-len(run) * max(1, len(self.model.bodies.name)) // NUMBERS))
        self.thinned = stride > 1
        self.run = run.pick(np.arange(stride - 1, len(run), stride)) if stride > 1 else run
        self.h = run.info.step
        self.every_step = (stride == 1 and len(run) > 1
                           and abs(float(run.time[1] - run.time[0]) / self.h - 1) < 1e-6)

    @cached_property
    def loads(self) -> Loads:
        """The loads in all samples."""
        return Loads(self.run)

    @cached_property
    def vectors(self) -> bool:
        """Whether joints' forces were kept as vectors."""
        return not np.isnan(self.run.arrays["joint_force"]).all() or not self.model.joints.name

    @cached_property
    def few(self) -> Evidence:
        """The same with about :data:`SAMPLES` samples."""
        stride = max(1, len(self.run) // SAMPLES)
        if stride == 1:
            return self
        first = (len(self.run) - 1) % stride
        return self.picked(np.arange(first, len(self.run), stride))

    def picked(self, samples: Integers) -> Evidence:
        """The same of some samples only."""
        return self._part(self.run.pick(samples), samples)

    @cached_property
    def last(self) -> Evidence:
        """The last sample alone."""
        count = len(self.run)
        return self._part(self.run.part(count - 1, count), np.array([count - 1]))

    def _part(self, run: Samples, samples: Integers) -> Evidence:
        part = Evidence(run)
        part.every_step = False
        part.__dict__["shift"] = self.shift[samples]  # known from the neighbours of each sample
        part.__dict__["busy"] = self.busy[samples]
        return part

    @cached_property
    def shift(self) -> Array:
        """By how much poses were corrected after the forces were known, at most [m], [n]."""
        a = self.run.arrays
        result = np.zeros(len(self.run))
        beyond = np.maximum(-a["contact_gap"] - OVERLAP, 0.0)
        np.maximum.at(result, a["contact_sample"], beyond)
        result[1:] = np.maximum(result[1:], result[:-1])  # a contact that has just let go
        return result

    @cached_property
    def busy(self) -> Flags:
        """Samples in which the solver had more than joints to solve, so that it stopped short, [n].

        Contacts, stops, ropes, motors and brakes meet the joints in one iteration,
        which is ended after a fixed number of rounds.
        """
        a = self.run.arrays
        result: Flags = np.array(np.nan_to_num(a["joint_stop"]).any(axis=1))
        result |= np.nan_to_num(a["drive_torque"]).any(axis=1)
        if len(self.model.joints.keeping("range")):
            result[:] = True
        result[a["contact_sample"]] = True
        result[1:] |= result[:-1]
        return result

    @cached_property
    def joint_slack(self) -> Array:
        """How far apart a joint's anchors may drift in one step [m], [nj, n].

        Velocities before the step close the joint to first order. What is left
        is a body's turning on while it moves straight on: h^2 omega^2 r / 2 of
        each; a groove that turns under a sliding pin, h^2 omega v; a rod whose
        ends move across it, h^2 v^2 / (2 L). A tenth is added for the next order;
        while the solver is :attr:`busy`, joints are held no better than contacts,
        to :data:`OVERLAP`.
        """
        frames, h = self.loads.frames, self.h
        v = frames.velocity - h / 2 * frames.acceleration
        ends = frames.anchors
        one, two = self.model.joints.bodies.T
        squares = [v[2][one] ** 2, v[2][two] ** 2]
        result = sum(square * np.hypot(end.arm_x, end.arm_y)
                     for square, end in zip(squares, ends, strict=True))
        result = np.asarray(result / 2)
        for j in self.model.joints.keeping("groove", "distance"):
            a, b = one[j], two[j]
            vx = (v[0][b] - v[2][b] * ends[1].arm_y[j]) - (v[0][a] - v[2][a] * ends[0].arm_y[j])
            vy = (v[1][b] + v[2][b] * ends[1].arm_x[j]) - (v[1][a] + v[2][a] * ends[0].arm_x[j])
            if self.model.joints.kind[j].keeps == "groove":
                reach = np.hypot(vx, vy) + np.abs(v[2][a]) * frames.gaps[j]
                result[j] += np.abs(v[2][a]) * reach
            else:
                result[j] += (vx**2 + vy**2) / (2 * np.maximum(frames.gaps[j], 1e-9))
        return np.asarray(1.1 * h * h * result + OVERLAP * self.busy)

    @cached_property
    def shortest(self) -> float:
        """Shortest stretch of tendon or spring that a force runs along [m]; 1 without any."""
        lengths = (self.few.loads.cords.length,
                   self.few.run.arrays["spring_length"][:, self.model.springs.straight])
        found = [float(part.min(initial=np.inf)) for part in lengths]
        least = min(found, default=np.inf)
        return least if np.isfinite(least) and least > 0 else 1.0
