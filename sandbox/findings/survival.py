"""Which grasp survives: maps over pose and friction of two hands, and the region of ejection.

A finger of two phalanges l_1, l_2 on a tendon with arms h_1, h_2 (X = h_2 / h_1) presses on a peg,
without friction, at k_1 and on a disc of friction mu at k_2, s its distal phalanx's half thickness.
With the force N and t N along the phalanx, |t| <= mu, moments about both hinges leave for the peg

    k_1 f_1 = tau_1 - N (k_2 + l_1 cos theta_2 + t (s - l_1 sin theta_2)),  N = tau_2 / (k_2 + t s)

so that some f_1 >= 0 is left to statics, with t = mu, where

    k_2 >= X l_1 (cos theta_2 - mu sin theta_2) / (1 - X) - mu s

and the pose stays. Otherwise the disc slides along the distal phalanx with t = mu, while its
distance from the first hinge, rho^2 = (k_2 + l_1 cos theta_2)^2 + (l_1 sin theta_2 - d)^2, is what
it was: it is ejected if k_2 = l_2 comes before that curve. For mu = 0 this is the grasp-state plane
of Birglen, Laliberte and Gosselin, Underactuated Robotic Hands (2008).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.regions import draw_regions
from sandbox.scene.library import shipped_studies
from sandbox.search.asking import Where
from sandbox.search.question import asked
from sandbox.search.regions import find_robustness
from sandbox.search.regions_figure import region_panels
from sandbox.search.regions_found import RobustnessFound

STAYS = "k2 - h2 / (h1 - h2) * l1 * (cos(second) - mu * sin(second)) + mu * thick"
"""The pose stays where this is above 0."""
_EDGE = "(acos((h1 - h2) * (l2 + mu * thick) / (h2 * l1 * sqrt(1 + mu**2))) - atan(mu))"
"""theta_2 of the curve at k_2 = l_2."""
KEPT = (f"max({STAYS}, (l2 + l1 * cos({_EDGE}))**2 + (l1 * sin({_EDGE}) - d)**2 "
        "- (k2 + l1 * cos(second))**2 - (l1 * sin(second) - d)**2)")
"""The disc is not ejected where this is above 0."""
TABLE = "survival.csv"
EJECTION, ADAPTIVE, OPPOSED = (
    "survival_ejection.png", "survival_adaptive.png", "survival_opposed.png")
LABELS = {
    "parameters.k2": "distal contact from the joint", "parameters.second": "angle of the joint",
    "parameters.mu": "friction", "parameters.x": "middle of the circle beside the knuckle",
    "parameters.y": "below by", "parameters.beside": "disc at first beside the middle",
    "contacts[1].friction": "friction", "parameters.push": "pushed with"}


@dataclass(frozen=True)
class SurvivalMap:
    """A map of the study."""

    name: str
    study: str
    holds: Sequence[str]
    closed: str = ""
    coarse: int = 6
    within: float = 1 / 24


MAPS = (
    SurvivalMap("stays", "ejection", ["moved < 0.2 deg"], STAYS, 6, 1 / 48),
    SurvivalMap("kept", "ejection", ["beyond < 0 mm"], KEPT, 6, 1 / 48),
    SurvivalMap("adaptive", "survival_adaptive", ["pressed > 0.05 N"]),
    SurvivalMap("opposed", "survival_opposed", ["moved < 5 mm"]),
)


def run(
    directory: Path, *, progress: Callable[[float], None] | None = None, workers: int = 0,
    cluster: str = "",
) -> str:
    """Find the maps, draw them, and say what came out.

    Raises:
        OutputError: a file cannot be written.
        SandboxError: no workers, or a cluster that cannot be used.
    """
    found = {}
    for done, each in enumerate(MAPS):
        found[each.name] = find_robustness(
            asked(str(shipped_studies()[each.study])), each.holds, coarse=each.coarse,
            within=each.within, boundary=each.closed, probes=24,
            place=Where(directory / each.name, workers, cluster))
        if progress:
            progress((done + 1) / len(MAPS))
    _draw(found, directory)
    write_atomic(directory / TABLE, survival_table(found))
    return "\n".join(conclusions(found)) + "\n"


def survival_table(found: Mapping[str, RobustnessFound]) -> str:
    """A row for each sheet of each map, as CSV: shares, and how a closed form agrees."""
    rows: list[list[object]] = []
    for name, each in found.items():
        for sheet in each.sheets:
            agreement = sheet.agreement
            closed: list[object] = [None] * 3 if agreement is None else [
                agreement.differs, agreement.passed, agreement.crossed]
            rows.append([name, LABELS.get(each.listed, each.listed), sheet.at, sheet.share,
                         sheet.low, sheet.high, *closed, each.runs, int(each.certified)])
    return comma_separated(
        ["map", "of", "at", "share", "low", "high", "differs", "passed", "crossed", "runs",
         "certified"], rows, digits=6)


def conclusions(found: Mapping[str, RobustnessFound]) -> list[str]:
    """What came out, a line for each map."""
    words = {"stays": "two phalanges: the pose stays in", "kept": "two phalanges: not ejected in",
             "adaptive": "adaptive grasp: the square stays held in",
             "opposed": "two against two: the free disc goes less than 5 mm in"}
    lines = []
    for name, each in found.items():
        label = LABELS.get(each.listed, each.listed)
        shares = ", ".join(f"{100 * sheet.share:.1f} % ({label} {sheet.at})"
                           for sheet in each.sheets)
        differs = [sheet.agreement.differs for sheet in each.sheets if sheet.agreement]
        closed = f"; the closed form differs in {100 * max(differs):.2g} % at most" \
            if differs else ""
        lines.append(f"{words[name]} {shares} of the map{closed}; half the step: "
                     f"{'the same' if each.certified else 'NOT the same'}")
    return lines


def _draw(found: Mapping[str, RobustnessFound], directory: Path) -> None:
    panels = [*region_panels(found["stays"], LABELS, "stays, "),
              *region_panels(found["kept"], LABELS, "kept, ")]
    draw_regions(directory / EJECTION, panels, closed="closed form",
                 title="Two phalanges on peg and disc: where the pose stays, where no disc is lost")
    draw_regions(directory / ADAPTIVE, region_panels(found["adaptive"], LABELS),
                 title="Adaptive grasp: where the square is held between finger and circle")
    draw_regions(directory / OPPOSED, region_panels(found["opposed"], LABELS),
                 title="Two fingers against two: where a pushed free disc goes less than 5 mm")
