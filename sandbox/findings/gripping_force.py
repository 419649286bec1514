"""Does the gripping force depend on the object? Over a thousand random sections, and why.

The paper reads off its Figure 7 that the largest force of any phalanx is between 1 and 2 N
whatever position it takes. Without friction the section decides the pose, and pose and tension
decide the forces, f = J^-T tau: :mod:`sandbox.mechanics.embrace` finds both without the engine.
A phalanx beyond which nothing presses presses with tau_i / k_i: torque over distance from its
hinge. So the force hangs on the object, by where on its phalanges that touches.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure import style
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.draw.figure.populations import (
    Agreeing,
    ClassPlane,
    OneSpread,
    SpreadRow,
    save_agreement,
    save_classes,
    save_spreads,
)
from sandbox.draw.film.side_by_side import draw_ends
from sandbox.engine.simulate import simulate
from sandbox.findings.hand_rows import (
    AT_REST,
    FINGERS,
    PHALANGES,
    PRESSES,
    RAMP,
    HandRows,
    closing_finger,
    doubts,
    hand_rows,
)
from sandbox.findings.sweeping import run_sweeps
from sandbox.mechanics.embrace import ClosingFinger, Embraced, Pull, close_on_discs, near_disc
from sandbox.numeric import Array, Flags
from sandbox.scene.read.load import load_scene
from sandbox.sweeps.table import SweepTable

SWEEPS = {"discs": "gripping_force_discs", "squares": "gripping_force_squares"}
CLAIM = (1.0, 2.0)
"""Of the force of a phalanx, as the paper says [N]."""
BEST = 25.0
"""The pull of the study files at which most largest forces are as claimed [N]."""
RIGHT = 5.0
"""The largest force that distributions show [N]."""
PULLS = np.array([10, 12.5, 15, 17.5, 20, 22.5, 25, 27.5, 30, 35, 40])
"""Of the closed form [N]."""
SOME = 256
"""Discs of which the closed form is asked at these."""
SIZES = (("radius 6 to 10 mm", 0.0, 0.010), ("radius 10 to 16 mm", 0.010, 0.016),
         ("radius 16 to 26 mm", 0.016, np.inf))
LEVELS = (("below 1 N", style.BLUE), ("1 to 2 N", style.GREEN), ("above 2 N", style.ORANGE))
ROLES = (("outermost: f = τ / k", style.ORANGE), ("outermost, on a stop", style.OCHRE),
         ("more press beyond", style.BLUE))
AT_STOP = 1e-6
"""A hinge this near to a stop is on it [rad]."""
SHOWN: Mapping[str, Any] = {
    "pull": BEST, "r1": 0.020, "x1": 0.015, "gap1": 0.012, "r2": 0.022, "x2": 0.050,
    "gap2": 0.020, "r3": 0.008, "x3": 0.003, "gap3": 0.006, "r4": 0.009, "x4": 0.022,
    "gap4": 0.015}
"""The discs of the picture of the hand."""


@dataclass(frozen=True)
class GripCase:
    """The fingers at rest under one condition."""

    name: str
    rows: HandRows

    @property
    def largest(self) -> Array:
        """Of the forces of a finger [N], shape [m]."""
        return np.asarray(self.rows.forces.max(axis=1))

    @property
    def as_claimed(self) -> Flags:
        """Which fingers have their largest force between 1 and 2 N, shape [m]."""
        return within(self.largest)

    @property
    def each(self) -> Flags:
        """Of which fingers every phalanx that presses does so with 1 to 2 N, shape [m]."""
        return np.asarray((within(self.rows.forces) | ~self.rows.pressing).all(axis=1)
                          & self.rows.pressing.any(axis=1))


def within(forces: Array) -> Flags:
    """Which forces are between 1 and 2 N."""
    return np.asarray((forces >= CLAIM[0]) & (forces <= CLAIM[1]))


def run(directory: Path, *, progress: Callable[[float], None] | None = None, workers: int = 0,
        cluster: str = "") -> str:
    """Run what is missing of both sweeps, write pictures and tables; what came out.

    Raises:
        OutputError: a file cannot be written.
    """
    tables = run_sweeps(SWEEPS, directory, progress, workers=workers, cluster=cluster)
    cases = [*cases_of(tables["discs"], "parameters.pull", "discs, pull {:g} N"),
             *cases_of(tables["squares"], "parameters.friction", "with squares, friction {:g}")]
    finger = closing_finger("four_discs")
    discs = [case for case in cases if case.name.startswith("discs")]
    predicted = [closed(finger, case.rows) for case in discs]
    best = next(case for case in discs if f"{BEST:g} N" in case.name)
    _draw(directory, cases, discs, predicted)
    _draw_best(directory, finger, best)
    shares = pull_shares(finger, best.rows)
    save_panels(directory / "pulls.png", [_pulls(shares, discs)])
    draw_ends([simulate(load_scene("four_discs", overrides={
        f"parameters.{name}": value for name, value in SHOWN.items()}))], [""], [{}],
        directory / "hand.png", width=640, columns=1)
    write_atomic(directory / "shares.csv", shares_csv(cases))
    write_atomic(directory / "pulls.csv", comma_separated(
        ["pull_N", "largest_1_to_2", "each_1_to_2"], shares))
    return summary(cases, discs, predicted, tables)


def cases_of(table: SweepTable, path: str, name: str) -> list[GripCase]:
    """The fingers at rest for each value of a path, which ``name`` takes in."""
    rows = hand_rows(table)
    values = table[path][rows.runs]
    return [GripCase(name.format(value), rows.only((values == value) & rows.sound))
            for value in np.unique(values).tolist()]


def closed(finger: ClosingFinger, rows: HandRows, tension: Array | None = None) -> Embraced:
    """What the closed form says of the discs of some rows, at the tensions that they had."""
    return close_on_discs(finger, rows.centres(finger.radii[0]), rows.radius,
                          Pull(rows.tension if tension is None else tension), RAMP)


def pull_shares(finger: ClosingFinger, rows: HandRows) -> Array:
    """For each of some pulls the share of objects, shape [pulls, 3], by the closed form.

    Pull [N], share with the largest force in 1 to 2 N, share with each that presses in it.
    """
    some = rows.only(np.arange(len(rows.runs)) < SOME)
    found = []
    for pull in PULLS:
        there = closed(finger, some, np.full(len(some.runs), pull / FINGERS))
        rest = there.forces[there.residual < AT_REST]
        band = within(rest) | (rest <= PRESSES)
        found.append((pull, within(rest.max(axis=1)).mean(),
                      (band.all(axis=1) & (rest > PRESSES).any(axis=1)).mean()))
    return np.array(found)


def _draw(directory: Path, cases: Sequence[GripCase], discs: Sequence[GripCase],
          predicted: Sequence[Embraced]) -> None:
    save_spreads(
        directory / "forces.png", [SpreadRow(_called(case), [
            _spread(name if place == 0 else "", case, i) for i, name in enumerate(PHALANGES)])
            for place, case in enumerate(cases)],
        x="force of the phalanx [N]", y="objects", right=RIGHT, band=CLAIM,
        footnote="Shaded: 1 to 2 N, as the paper says. Phalanges that do not press are left out "
        f"of the distributions; forces above {RIGHT:g} N are in the last column.")
    groups = [Agreeing(name, np.concatenate([there.forces[_rest(there), i]
                                              for there in predicted]),
                        np.concatenate([case.rows.forces[_rest(there), i]
                                        for case, there in zip(discs, predicted, strict=True)]))
              for i, name in enumerate(PHALANGES)]
    save_agreement(directory / "closed_form.png", groups, x="force by the closed form [N]",
                   y="force of the simulation [N]", difference="difference [N]", least=1e-12)


def _spread(title: str, case: GripCase, i: int) -> OneSpread:
    on, inside = case.rows.pressing[:, i], within(case.rows.forces[:, i])
    return OneSpread(title, case.rows.forces[on, i],
                     f"presses on {100 * on.mean():.0f} %\nof these {_percent(inside[on])}\n"
                     "with 1 to 2 N")


def _called(case: GripCase) -> str:
    text = case.name[0].upper() + case.name[1:]
    return f"{text}: largest force 1 to 2 N on {_percent(case.as_claimed)}"


def _rest(there: Embraced) -> Flags:
    return np.asarray(there.residual < AT_REST)


def _draw_best(directory: Path, finger: ClosingFinger, best: GripCase) -> None:
    """Where largest forces are as claimed, and how forces go with the place of the contact."""
    rows, level = best.rows, np.digitize(best.largest, CLAIM)
    planes = []
    for title, low, high in SIZES:
        these = (rows.radius >= low) & (rows.radius < high)
        planes.append(ClassPlane(title, 1e3 * rows.place[these], 1e3 * rows.gap[these],
                                 level[these]))
    save_classes(directory / "places.png", [planes], LEVELS,
                 x="from the hinge [mm]", y="gap below the finger [mm]",
                 footnote=f"Places of the discs' centres along the finger; largest force of the "
                 f"three phalanges, pull {BEST:g} N. The straight phalanges end at 45, 71 and 92 "
                 "mm.")
    k = near_disc(rows.theta, finger.lengths, finger.radii, rows.centres(finger.radii[0]),
                  rows.radius).distances
    on = rows.pressing
    role = np.stack([on[:, i + 1:].any(axis=1) for i in range(len(PHALANGES))], axis=1) * 2
    stopped = ((rows.theta < finger.limits[:, 0] + AT_STOP)
               | (rows.theta > finger.limits[:, 1] - AT_STOP))
    role = np.where((role == 0) & stopped, 1, role)
    save_classes(directory / "where.png", [[
        ClassPlane(name, 1e3 * k[on[:, i], i], rows.forces[on[:, i], i],
                   role[on[:, i], i]) for i, name in enumerate(PHALANGES)]],
        ROLES, x="from its hinge [mm]", y="force [N]", band=CLAIM, top=7.0, apart=True,
        footnote=f"Where on each phalanx the disc touches, and the force there. Pull {BEST:g} N; "
        "shaded: 1 to 2 N. Outermost: nothing presses beyond it.")


def _pulls(shares: Array, discs: Sequence[GripCase]) -> Panel:
    pulls = np.array([_pull(case) for case in discs])
    return Panel("What the pull does", "pull of the actuator [N]", "share of objects [%]", [
        Curve("largest force 1 to 2 N, closed form", shares[:, 0], 100 * shares[:, 1]),
        Curve("largest force 1 to 2 N, simulation", pulls,
              np.array([100 * case.as_claimed.mean() for case in discs]), "points"),
        Curve("each that presses 1 to 2 N, closed form", shares[:, 0], 100 * shares[:, 2]),
        Curve("each that presses 1 to 2 N, simulation", pulls,
              np.array([100 * case.each.mean() for case in discs]), "points")])


def _pull(case: GripCase) -> float:
    return float(case.name.split()[-2])


def _percent(flags: Flags) -> str:
    return f"{100 * flags.mean():.0f} %" if len(flags) else "none"


def shares_csv(cases: Sequence[GripCase]) -> str:
    """A line for each phalanx of each case: shares and quantiles of the force where it presses."""
    rows: list[list[object]] = []
    for case in cases:
        columns = [*zip(PHALANGES, case.rows.forces.T, strict=True), ("largest", case.largest)]
        for name, forces in columns:
            on = forces > PRESSES
            cells: list[object] = [None] * 4 if not on.any() else [
                within(forces[on]).mean(), *np.percentile(forces[on], [5, 50, 95])]
            rows.append([case.name, name, len(forces), on.mean(), *cells])
    return comma_separated(
        ["case", "phalanx", "objects", "presses", "of_these_1_to_2", "force_5_percent_N",
         "force_median_N", "force_95_percent_N"], rows)


def summary(cases: Sequence[GripCase], discs: Sequence[GripCase], predicted: Sequence[Embraced],
            tables: Mapping[str, SweepTable]) -> str:
    """What came out: shares as claimed, numbers of contacts, how far the closed form is off."""
    lines = []
    for case in cases:
        count = np.bincount(case.rows.pressing.sum(axis=1), minlength=4)
        shares = ", ".join(f"{100 * n / count.sum():.0f} %" for n in count)
        lines.append(
            f"{case.name}: largest force 1 to 2 N on {_percent(case.as_claimed)} of "
            f"{len(case.largest)} objects (below on {_percent(case.largest < CLAIM[0])}, above on "
            f"{_percent(case.largest > CLAIM[1])}), each that presses on {_percent(case.each)}; "
            f"0, 1, 2, 3 phalanges press on {shares}.")
    off = np.concatenate([np.abs(case.rows.forces - there.forces).max(axis=1)[_rest(there)]
                          for case, there in zip(discs, predicted, strict=True)])
    share = max(float(np.abs(case.rows.tension * FINGERS / _pull(case) - 1).max())
                for case in discs)
    unsettled = sum(int((~_rest(there)).sum()) for there in predicted)
    return "\n".join([
        *lines, f"Closed form: half of {len(off)} objects within {np.median(off):.1g} N, 99 % "
        f"within {np.percentile(off, 99):.1g} N, {int((off > PRESSES).sum())} of them at another "
        f"rest; of {unsettled} it finds none. Tensions are a quarter of the pull within "
        f"{100 * share:.1f} %.", doubts(tables)])
