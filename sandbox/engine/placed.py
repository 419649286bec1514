"""What all tables of the compiled step are made from: where bodies are, and the bilateral rows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.scene.geometry import to_world


@dataclass
class Rows:
    """The bilateral rows, as they come: of each the bodies of its entries."""

    bodies: list[list[int]] = field(default_factory=list)
    entries: int = 0

    def add(self, *bodies: int) -> tuple[int, int]:
        """A row; its number, and that of its first entry."""
        self.bodies.append(list(bodies))
        self.entries += len(bodies)
        return len(self.bodies) - 1, self.entries - len(bodies)


@dataclass(frozen=True)
class PlacedBodies:
    """Where bodies are: their numbers in pymunk's order, what they weigh, poses at t = 0."""

    model: Model
    number: Integers
    """By the model's numbers, [nb]."""
    inverse_mass: Array
    """In pymunk's order, [nb, 2]."""
    pose: Array
    """Of the centres of mass, in pymunk's order, [nb, 3]."""

    def local(self, body: int, point: Array) -> Array:
        """A point of a body's frame seen from its centre of mass [m]."""
        local: Array = point - self.model.bodies.centre[body]
        return local


def place_bodies(model: Model, order: Integers) -> PlacedBodies:
    """Bodies as pymunk lists them; ``order`` are the model's numbers of these."""
    bodies = model.bodies
    number = np.argsort(order)
    inverse = np.stack([1 / bodies.mass[order], 1 / bodies.inertia[order]], axis=1)
    pose: Array = np.array([
        (*to_world(tuple(bodies.pose[i]), tuple(bodies.centre[i])), bodies.pose[i, 2])
        for i in order]).reshape(-1, 3)
    return PlacedBodies(model, number, inverse, pose)
