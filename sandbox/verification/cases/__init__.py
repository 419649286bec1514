"""The verification cases: one concept a file, all of them in :data:`CASES`."""

from sandbox.verification.cases import (
    accuracy,
    control,
    cords,
    differential,
    dynamics,
    fluids,
    friction,
    gears,
    geometry,
    grasp_state,
    grasping,
    hands,
    impacts,
    lifting,
    loads,
    motion,
    outlines,
    resting,
    rubbing,
    spring_laws,
    statics,
    ties,
)
from sandbox.verification.cases.case import Case

CASES: tuple[Case, ...] = (
    *differential.CASES, *geometry.CASES, *dynamics.CASES, *statics.CASES, *grasp_state.CASES,
    *grasping.CASES, *hands.CASES, *motion.CASES, *friction.CASES, *impacts.CASES, *rubbing.CASES,
    *fluids.CASES, *outlines.CASES,
    *spring_laws.CASES, *loads.CASES, *gears.CASES, *cords.CASES, *lifting.CASES, *ties.CASES,
    *resting.CASES, *control.CASES, *accuracy.CASES)

__all__ = ["CASES", "Case"]
