"""The display list of a run: all elements in their order."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sandbox.picture.bars import bars_of
from sandbox.picture.bounds import drift
from sandbox.picture.elements.bodies import add_bodies, add_stalks, add_wheels
from sandbox.picture.elements.cords import add_cords
from sandbox.picture.elements.drives import add_belts, add_drives
from sandbox.picture.elements.fluids import add_fluids
from sandbox.picture.elements.forces import add_contacts, add_loads, add_vectors
from sandbox.picture.elements.joints import add_grounds, add_joints, add_latches, add_stops
from sandbox.picture.elements.links import add_bars, add_links, add_springs
from sandbox.picture.elements.notes import add_axes, add_liquids, add_names, add_traces
from sandbox.picture.elements.pressure import add_pressure
from sandbox.picture.legend import add_legend
from sandbox.picture.listing import Listing
from sandbox.picture.palette import DRIVE, PUSH, SLACK, SPRING, TENSION, css, mixed
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import ForceScale, force_scale, shared
from sandbox.picture.subject import Subject, VisibleLayers
from sandbox.picture.tensions import Tensions, tensions_of
from sandbox.scene.settings import View

ELEMENTS: tuple[Callable[[Subject], None], ...] = (
    add_liquids, add_bodies, add_stalks, add_wheels, add_joints, add_links, add_grounds,
    add_stops, add_latches, add_springs, add_bars, add_belts, add_fluids, add_cords, add_traces,
    add_axes, add_pressure, add_contacts, add_loads, add_vectors, add_drives, add_names,
)
"""What adds items to a list; a new kind of element is a function here."""
STEPS = 8
"""Colours of springs on either side of their own stiffness."""


RAMPS = {"load": [[css(c) for c in PUSH], [css(c) for c in TENSION]],
         "stiffness": [[css(mixed(SPRING, other, k / (STEPS - 1))) for k in range(STEPS)]
                       for other in (SLACK, DRIVE)]}
"""The ramps of loads (push and pull) and of driven stiffness."""


def tensions(run: RunData, layers: VisibleLayers, beside: Sequence[RunData],
             view: View) -> Tensions:
    """What cords, links and bars carry, on the scale that some runs share."""
    own = tensions_of(run, bars_of(run, layers.of("bars")))
    return own.beside(tensions_of(each, bars_of(each, VisibleLayers(each, view).of("bars")))
                      for each in beside)


def subject_of(run: RunData, view: View, *, width: float, point: float,
               beside: Sequence[RunData] = (), moments: Sequence[float] | None = None,
               fixed_columns: bool = False, force: ForceScale | None = None) -> Subject:
    """The list of a run with all that its layers show.

    Args:
        run: the recording.
        view: what to show.
        width: of what the picture shows [m], by which arrows are measured.
        point: metres per point.
        beside: runs that share its scales.
        moments: the times that are painted [s], if they are few.
        fixed_columns: see :class:`Listing`.
        force: the scale of contact forces, by default that of the runs.
    """
    layers = VisibleLayers(run, view)
    carried = tensions(run, layers, beside, view)
    out = Listing.of(run.time, run.arrays["body_pose"], fixed_columns=fixed_columns)
    out.ramps = RAMPS
    if view.follow:
        out.drift = drift(run, view)
    s = Subject(run, view, layers, out, carried if "tensions" in layers else carried.hidden(),
                force or shared(force_scale(each, width, view) for each in (run, *beside)),
                width, point, beside, moments)
    for add in ELEMENTS:
        add(s)
    add_legend(s, carried)
    s.close()
    return s
