"""A rod that topples on its round end, and one that slides down a wall: one angle each.

The angle a is that from upright. A uniform rod with its centre c from the centres of its round
ends of radius r. Rolling: x = r a + c sin a, y = r + c cos a, and the energy

    (I + m (r^2 + c^2 + 2 r c cos a)) a'^2 / 2 + m g c cos a

is kept. On a smooth floor and wall, x = r + c sin a, y = r + c cos a and
(I + m c^2) a'' = m g c sin a.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.hard.truth.integrate import motion

G = 9.81


@dataclass(frozen=True)
class Rod:
    """A uniform rod of ``length`` between the centres of its ends, let go at ``start``."""

    mass: float
    length: float
    radius: float
    start: float

    @property
    def inertia(self) -> float:
        return self.mass * self.length**2 / 12

    def _course(self, times: np.ndarray, roll: float) -> np.ndarray:
        """Angle, rate and acceleration, shape [3, n]; ``roll`` is r where it rolls, else 0."""
        m, c = self.mass, self.length / 2

        def acceleration(a: np.ndarray, w: np.ndarray) -> np.ndarray:
            turned = self.inertia + m * (roll**2 + c**2 + 2 * roll * c * np.cos(a))
            return m * c * np.sin(a) * (G + roll * w**2) / turned

        found = motion(times, acceleration, np.array([self.start]), np.zeros(1))[:, :, 0]
        return np.stack([*found, acceleration(*found)])

    def _forces(self, course: np.ndarray, roll: float) -> np.ndarray:
        """Of the floor upwards and of all along x, from the centre's acceleration, [2, n]."""
        a, w, alpha = course
        c = self.length / 2
        across = roll * alpha + c * (np.cos(a) * alpha - np.sin(a) * w**2)
        up = -c * (np.sin(a) * alpha + np.cos(a) * w**2)
        return self.mass * np.stack([G + up, across])

    def toppling(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Angle [rad], shape [n]; normal and friction force on the rod [N], shape [2, n]."""
        course = self._course(times, self.radius)
        return course[0], self._forces(course, self.radius)

    def ladder(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Angle [rad], shape [n]; forces of the floor and of the wall [N], shape [2, n]."""
        course = self._course(times, 0.0)
        return course[0], self._forces(course, 0.0)
