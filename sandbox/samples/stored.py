"""What a run leaves behind as it was stored: the mechanism, plain arrays, facts about the run."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import Arrays, completed, dtype_of, faults
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.samples.contacts import Contacts
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism


class Stored:
    """The mechanism that was run and plain arrays, SI, nothing of the engine.

    n samples, nb bodies, nj joints, ns springs, nt tendons, nd drives, in the
    mechanism's order; m contact rows.

    * ``time`` [n]: poses and forces of a sample belong to this instant; even
      spacing; the first is not at 0, since the scheme is a leapfrog.
    * ``body_pose`` [n, nb, 3]: x, y, angle of each frame's origin; ``body_velocity`` and
      ``body_acceleration`` [n, nb, 3]: of the centre of mass.
    * ``body_centre`` [nb, 2]: centre of mass in the body's frame; ``body_mass``,
      ``body_inertia`` [nb]: about the centre, infinite for what is fixed or scheduled.
    * ``joint_angle``, ``joint_rate`` [n, nj]: nan unless a pin; ``joint_reaction`` [n, nj]:
      size of the force, ``joint_force`` [n, nj, 2] on the body ``b`` in the world;
      ``joint_couple`` [n, nj]: of welds and sliders, on ``b``; ``joint_stop``,
      ``joint_damping`` [n, nj]: torques of the hard stop and of the dampers, in the joint's sense.
    * ``spring_length``, ``spring_force`` [n, ns]: positive pulls; of a rotary spring the
      hinge's angle and the torque, which is positive against a positive angle.
    * ``tendon_length``, ``tendon_tension`` [n, nt]; ``tendon_initial`` (at t = 0),
      ``tendon_rest`` [nt].
    * ``drive_value`` [n, nd] in the drive's unit; ``drive_torque`` [n, nd]: of motors and brakes,
      in the joint's sense, nan for other drives.
    * ``drive_work``, ``tendon_work``, ``spring_work``, ``joint_damping_work``: done on the bodies
      since t = 0 [J], added up in every step.
    * ``mean_joint_force`` and so on: means over the interval around each sample, if samples are
      several steps apart.
    * ``impact_time``, ``impact_body``, ``impact_other`` [k], ``impact_point``,
      ``impact_impulse`` [k, 2]: contacts that were hit.
    * ``contact_sample``, ``contact_body``, ``contact_other`` [m]: one row per touching pair
      and sample, in this order; ``contact_point``, ``contact_force`` (on body by other),
      ``contact_normal`` [m, 2]; ``contact_gap`` [m]: negative where they overlap;
      ``contact_merged`` [m]: how many points of touch the row stands for; ``contact_twist`` [m]:
      moment on the other body besides the force's.

    The arrays are read-only. ``info`` says how the run ended and how it was computed. ``model``
    is the mechanism's, where it is known; otherwise it is compiled when first asked for.

    Raises:
        ValueError: arrays that are missing or do not fit the mechanism.
    """

    def __init__(
        self, mechanism: Mechanism, arrays: Mapping[str, NDArray[Any]], info: Outcome, *,
        model: Model | None = None, scratch: object = None,
    ) -> None:
        self.mechanism = mechanism
        self._model = model
        self.arrays: Arrays = {key: _read_only(key, array)
                               for key, array in completed(mechanism, arrays).items()}
        if found := faults(mechanism, self.arrays):
            raise ValueError("; ".join(found))
        self.info = info
        self._scratch = scratch

    @property
    def time(self) -> Array:
        """Instants of the samples [s], shape [n]."""
        return self.arrays["time"]

    @property
    def complete(self) -> bool:
        """Whether the run came to its planned end."""
        return self.info.complete

    def __len__(self) -> int:
        return len(self.time)

    @property
    def model(self) -> Model:
        """The mechanism with its names worked out."""
        if self._model is None:
            self._model = compile_mechanism(self.mechanism)
        return self._model

    @cached_property
    def contacts(self) -> Contacts:
        """The contact rows, for sums by body, pair and group."""
        return Contacts(self.arrays, samples=len(self), bodies=len(self.mechanism.bodies))


def _read_only(key: str, array: NDArray[Any]) -> NDArray[Any]:
    view = np.asarray(array, dtype=dtype_of(key)).view()
    view.setflags(write=False)
    return view
