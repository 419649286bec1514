"""What of an equilibrium is told: its quantities by name, in the order of a table."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.equilibria.rest import AtRest
from sandbox.recording.recording import Recording
from sandbox.samples.contacts import TOUCH


def quantities(run: Recording) -> dict[str, str]:
    """Quantities that tell an equilibrium, by name, with their units.

    Angles of hinges, places of bodies that hang on none, tensions, forces of springs, contacts.
    """
    model = run.model
    names = [f"{model.joints.name[j]}.angle" for j in model.joints.hinges.tolist()]
    names += [f"{name}.length" for name in model.joints.name]
    hinged = set(model.joints.bodies[model.joints.pivots, 1].tolist())
    names += [f"{model.bodies.name[i]}.{part}" for i in np.flatnonzero(model.bodies.free).tolist()
              if i not in hinged for part in ("x", "y", "angle")]
    names += [f"{name}.tension" for name in model.tendons.name]
    names += [f"{name}.{part}" for name in model.springs.name for part in ("force", "torque")]
    names += [f"{name}.pressure" for name in model.lines.name]
    names += list(_contacts(run))
    known = [name for name in names if name in run]
    return {name: run.unit(name) for name in known}


def places(run: Recording) -> list[str]:
    """Quantities that say where everything is: hinges and free bodies."""
    model = run.model
    free = np.flatnonzero(model.bodies.free).tolist()
    return [name for name in (
        *(f"{model.joints.name[j]}.angle" for j in model.joints.hinges.tolist()),
        *(f"{model.bodies.name[i]}.{part}" for i in free for part in ("x", "y", "angle")))
        if name in run]


def _contacts(run: Recording) -> Iterator[str]:
    names = run.model.bodies.name
    contacts = run.contacts
    for row in range(len(contacts.normal)):
        pair = f"{names[contacts.body[row]]}/{names[contacts.other[row]]}"
        yield f"{pair}.normal"
        if abs(contacts.tangential[row]) > TOUCH:
            yield f"{pair}.tangential"


def frequency(rest: AtRest) -> float:
    """Of the slowest motion that swings about rest [Hz]; nan where none does."""
    swings = rest.modes[rest.modes > 0]
    loose = len(rest.modes) - len(swings)
    if rest.stability != "stable" or loose or not len(swings):
        return float("nan")
    return float(np.sqrt(swings[0]) / (2 * np.pi))


def verdict(rest: AtRest) -> str:
    """Whether it is stable, in words."""
    if rest.stability == "unstable":
        grows = float(np.sqrt(-rest.modes[0]))
        return f"unstable: a small push grows e-fold every {1 / grows:.3g} s"
    if rest.stability == "neutral":
        moves = ", ".join(rest.loose) or "some bodies"
        return f"neutral: nothing answers a small motion of {moves}"
    if rest.stability == "not told":
        return f"rests; whether stable is not told with {rest.untold}"
    if not len(rest.modes):
        return "stable: nothing is free to move"
    return f"stable: its softest motion swings at {frequency(rest):.4g} Hz without damping"
