"""The audit: a recording checked against the paper's equations and the laws of mechanics.

Everything is worked out from the recording alone; the solver is not asked.
Every figure has a threshold that follows from the time step and the solver,
said beside it and in docs/audit.md, and a verdict: ``pass``, ``look``, or ``not
computed`` with the reason.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from sandbox.audit.balance import balance_figures
from sandbox.audit.bounds import bound_figure
from sandbox.audit.contacts import contact_figures
from sandbox.audit.driven import driven_figures
from sandbox.audit.energy import energy_figures
from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import Figure, figure_data, missing
from sandbox.audit.fluids import fluid_figures
from sandbox.audit.friction import friction_figures
from sandbox.audit.geometry import geometry_figures
from sandbox.audit.laws import law_figures
from sandbox.audit.motion import motion_figures
from sandbox.audit.rest import rest_figures
from sandbox.audit.ties import tie_figures
from sandbox.samples.samples import Samples

__all__ = ["Figure", "audit", "figure_data"]

PARTS: tuple[tuple[str, Callable[[Evidence], Iterable[Figure]]], ...] = (
    ("geometry", geometry_figures),
    ("motion", motion_figures),
    ("laws", law_figures),
    ("friction", friction_figures),
    ("fluids", fluid_figures),
    ("release", tie_figures),
    ("driven", driven_figures),
    ("balance", balance_figures),
    ("energy", energy_figures),
    ("rest", rest_figures),
    ("contacts", contact_figures),
    ("contact.bounds", lambda evidence: [bound_figure(evidence)]),
)


def audit(run: Samples) -> list[Figure]:
    """All figures of a recording, in the order of the docs."""
    if not len(run):
        return [missing(name, why="nothing was recorded", source="") for name, _ in PARTS]
    evidence = Evidence(run)
    figures: list[Figure] = []
    with np.errstate(all="ignore"):
        for name, part in PARTS:
            try:
                figures.extend(part(evidence))
            except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
                # numbers that are none, of a run that diverged: say so, and lose no other figure
                figures.append(missing(name, why=f"the numbers cannot be used: {error}", source=""))
    if run.mechanism.run.solver == "pymunk":
        figures = [missing(figure.name, why="pymunk does not give its numbers",
                           source=figure.source) if math.isnan(figure.value) else figure
                   for figure in figures]
    return figures
