"""Robustness maps: over which values of one or two paths something holds, and where it ceases to.

The boundary is found by dividing cells (:mod:`sandbox.search.cells`), not by a dense grid. Random
points in cells that are taken for decided say how much a coarse grid can have missed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sandbox.errors import SandboxError
from sandbox.numeric import Array, Integers
from sandbox.search.asking import FIGURE, Asking, Where, affordable, asking
from sandbox.search.cells import FAILS, HOLDS, SILENT, UNDECIDED, Divided, Edge, Node, divide, trace
from sandbox.search.closed_form import ClosedForm, closed_form
from sandbox.search.criteria import Condition, RefusedError, conditions, holds, why_none
from sandbox.search.logistic import wilson
from sandbox.search.question import Question
from sandbox.search.regions_figure import draw_robustness
from sandbox.search.regions_found import Agreement, RobustnessFound, RobustnessSheet
from sandbox.sweeps.points import number_of
from sandbox.sweeps.searching import COARSE, FINEST, PROBES, RUNS, WITHIN

MOST_SHEETS = 9
AGAIN = 12
"""Places of the boundary that are looked at again at half the step."""
WORDS = {HOLDS: "holds", FAILS: "does not hold", SILENT: "no answer", UNDECIDED: "undecided"}


def find_robustness(
    question: Question, where: Sequence[str] = (), *, coarse: int = COARSE, within: float = WITHIN,
    runs: int = RUNS, probes: int = PROBES, boundary: str = "", seed: int = 0,
    place: Where | None = None,
) -> RobustnessFound:
    """Where in a range, or in the square of two, a condition holds.

    Args:
        question: one or two paths with ranges, and at most one with a list: a map for each value.
        where: conditions such as ``"moved < 1 mm"``; without, the scene's expectations.
        coarse: cells along each range at first; what is smaller than one of them may be missed.
        within: the width of the smallest cells, as a share of each range.
        runs: at most so many, without those that look for what was missed and the certificate.
        probes: random points in decided cells that say how much was missed.
        boundary: a closed form, greater than 0 where it should hold.
        seed: of the probes.
        place: where it runs and what it leaves behind.

    Raises:
        RefusedError: every problem of what is asked, a line each.
        SceneError: more runs than the limit.
        SandboxError: no run has an answer.
    """
    question = replace(question, space=question.space.rising())
    levels = -1
    if within > 0 < coarse:  # 1/48 of 1/6 is an eighth, whatever rounding leaves of it
        levels = max(math.ceil(-math.log2(coarse * within) - 1e-9), 0)
    wanted, form = _sound(question, where, coarse, levels, runs, boundary)
    affordable(question, runs + probes, seed)
    place = place or Where()
    with asking(question, place) as work:
        ground = _Ground(work, wanted, coarse * 2 ** levels)
        found = divide(ground.ask, sheets=ground.sheets, ways=len(question.space.spans),
                       coarse=coarse, levels=levels, most=runs)
        if not set(found.answers.values()) - {SILENT}:
            raise SandboxError(f"no run tells whether {ground.condition}; the first: "
                               f"{ground.silent[0]}", code="no-answer")
        told = _told(ground, found, form, probes, seed)
        if place.out:
            work.leave(place.out, "robustness", told.data(), wanted=wanted, holds=where,
                       coarse=coarse, within=within, runs=runs, probes=probes, boundary=boundary,
                       seed=seed)
            draw_robustness(told, place.out / FIGURE)
    return told


def _sound(
    question: Question, where: Sequence[str], coarse: int, levels: int, runs: int, boundary: str,
) -> tuple[tuple[Condition, ...], ClosedForm | None]:
    """The conditions and the closed form, and nothing wrong with what is asked."""
    space, problems = question.space, list[str]()
    wanted: tuple[Condition, ...] = ()
    if len(space.spans) not in (1, 2) or len(space.lists) > 1 or space.random:
        problems.append("a map is over one or two ranges, as in '2 N:8 N', and one list of values "
                        f"at most, a map for each: not over {len(space.spans)} ranges, "
                        f"{len(space.lists)} lists and {len(space.random)} distributions")
    sheets = [len(space.over[path]) for path in space.lists]  # type: ignore[arg-type]
    if max(sheets, default=0) > MOST_SHEETS:
        problems.append(f"a list has {max(sheets)} values (allowed: at most {MOST_SHEETS}, as many "
                        "maps)")
    if levels < 0 or coarse * 2 ** levels > FINEST:
        problems.append("cells are narrower than the range and no narrower than 1/"
                        f"{FINEST} of it: not {coarse} at first, and halved to what is asked for")
    elif runs < (first := math.prod(sheets) * (coarse + 1) ** len(space.spans)):
        problems.append(f"the coarse grid alone has {first} runs, and {runs} are allowed")
    for text in where:
        try:
            wanted += conditions([text], question.kept)
        except RefusedError as error:
            problems.append(str(error))
    if not where and not question.plan.loaded.mechanism.expect:
        problems.append("the scene expects nothing: say what must hold, as in \"moved < 1 mm\"")
    form = None
    try:
        form = closed_form(boundary, question) if boundary else None
    except RefusedError as error:
        problems.append(str(error))
    if problems:
        raise RefusedError("\n".join(problems))
    return wanted, form


class _Ground:
    """The lattice of a map, and the answers of its runs."""

    def __init__(self, work: Asking, wanted: tuple[Condition, ...], side: int) -> None:
        self.work, self.wanted, self.side = work, wanted, side
        self.space = work.question.space
        self.condition = " and ".join(each.text for each in wanted) or "what the scene expects"
        listed = self.space.over[self.space.lists[0]] if self.space.lists else None
        self.written = tuple(map(str, listed)) if isinstance(listed, tuple) else ("",)
        self.silent: list[str] = []
        """Why runs have no answer."""

    @property
    def sheets(self) -> int:
        """How many maps."""
        return len(self.written)

    def shares(self, places: Sequence[Sequence[float]]) -> Array:
        """Shares of the space of a sheet's number and places 0 to 1 along the ranges, [n]."""
        table = np.array(places, dtype=float)
        columns = {path: table[:, 1 + k] for k, path in enumerate(self.space.spans)}
        columns.update({path: (table[:, 0] + 0.5) / self.sheets for path in self.space.lists})
        return np.stack([columns[path] for path in self.space.paths], axis=1)

    def answers(self, places: Sequence[Sequence[float]], *, halved: bool = False) -> list[int]:
        """What runs answer at such places."""
        if not len(places):
            return []
        rows = self.work.rows(self.shares(places), halved=halved)
        found = [holds(row, self.wanted) for row in rows]
        self.silent += [why_none(row) for row, answer in zip(rows, found, strict=True)
                        if answer is None and not halved]
        return [SILENT if each is None else HOLDS if each else FAILS for each in found]

    def ask(self, nodes: Sequence[Node], *, halved: bool = False) -> list[int]:
        """What runs answer at nodes."""
        return self.answers([(node[0], *(at / self.side for at in node[1:])) for node in nodes],
                            halved=halved)

    def along(self, count: int) -> dict[str, Array]:
        """Numbers of each range [SI] at even shares from 0 to 1, [count]."""
        even = np.linspace(0.0, 1.0, count)
        table = self.space.numbers(self.shares([(0, *[at] * len(self.space.spans)) for at in even]))
        return {path: table[:, self.space.paths.index(path)] for path in self.space.spans}


def _told(
    ground: _Ground, found: Divided, form: ClosedForm | None, probes: int, seed: int,
) -> RobustnessFound:
    sheets = tuple(_sheet(ground, found, form, k) for k in range(ground.sheets))
    missed = _missed(ground, sheets, probes, seed)
    space = ground.space
    remarks = [missed] if missed else []
    if found.lacking:
        remarks.insert(0, f"cells of half the size take {found.lacking} more runs, more than are "
                          "allowed in all")
    if ground.silent:
        remarks.append(f"{len(ground.silent)} runs tell nothing, the first: {ground.silent[0]}")
    certified, certificate = _again(ground, found)
    table = ground.work.table(ground.wanted)
    return RobustnessFound(
        space.spans, tuple(space.units[path] for path in space.spans), (space.lists or ("",))[0],
        ground.condition, sheets, len(table), len(ground.silent), certified, certificate,
        form.text if form else "", tuple(remarks),
        _title(ground.work.question), table)


def _title(question: Question) -> str:
    plan = question.plan
    return plan.spec.title or plan.loaded.scene.title or plan.name


def _sheet(
    ground: _Ground, found: Divided, form: ClosedForm | None, sheet: int,
) -> RobustnessSheet:
    states = found.states(sheet)
    cells = [cell for cell in found.cells if cell.corner[0] == sheet]
    ends = ground.along(ground.side + 1)
    ways = list(ends.values())
    undecided = [cell for cell in cells if found.of(cell) is None]
    unit = 1.0 / states.size
    open_ = sum(cell.size ** states.ndim for cell in undecided) * unit
    share = float((states == HOLDS).mean())
    middle = share + sum(
        unit * cell.size ** states.ndim * np.mean(
            [found.answers[node] == HOLDS for node in cell.corners()]) for cell in undecided)
    lines = trace(found, sheet) if states.ndim == 2 else [
        np.array(edge)[:, 1:] / found.side for edge in found.crossed if edge[0][0] == sheet]
    written = ground.written[sheet]
    form_at = None
    agreement = None
    if form:
        form_at, agreement = _agreement(ground, form, found, sheet, states, ways)
    return RobustnessSheet(
        written, float(middle), share, share + float(open_), float((states == SILENT).mean()),
        tuple((*(float(way[at + by]) for way, at in zip(ways, cell.corner[1:], strict=True)
                 for by in (0, cell.size)), WORDS[_or_open(found.of(cell))]) for cell in cells),
        tuple(np.stack([np.interp(line[:, k], np.linspace(0, 1, len(way)), way)
                        for k, way in enumerate(ways)], axis=1) for line in lines),
        agreement, states, tuple(ways), form_at)


def _or_open(answer: int | None) -> int:
    return UNDECIDED if answer is None else answer


def _agreement(
    ground: _Ground, form: ClosedForm, found: Divided, sheet: int, states: Integers,
    ways: Sequence[Array],
) -> tuple[Array, Agreement]:
    """Values of a closed form at the lattice's nodes, and whether its signs are the answers."""
    grid = np.meshgrid(*ways, indexing="ij")
    numbers = dict(zip(ground.space.spans, grid, strict=True))
    value = number_of(ground.written[sheet]) if ground.space.lists else 0.0
    if ground.space.lists and isinstance(value, float):
        numbers[ground.space.lists[0]] = np.full_like(grid[0], value)
    at = form.at(numbers)
    centre = at
    for axis in range(states.ndim):
        centre = (np.take(centre, range(1, centre.shape[axis]), axis)
                  + np.take(centre, range(centre.shape[axis] - 1), axis)) / 2
    decided = (states == HOLDS) | (states == FAILS)
    differs = decided & ((centre > 0) != (states == HOLDS))
    edges = [edge for edge in found.crossed if edge[0][0] == sheet]
    passed = sum(bool((at[edge[0][1:]] > 0) == (found.answers[edge[0]] == HOLDS)
                 and (at[edge[1][1:]] > 0) == (found.answers[edge[1]] == HOLDS)) for edge in edges)
    return at, Agreement(float(differs.sum() / max(decided.sum(), 1)), passed, len(edges))


def _missed(
    ground: _Ground, sheets: Sequence[RobustnessSheet], probes: int, seed: int,
) -> str:
    """What random points in decided cells say of what the coarse grid missed."""
    places, expected = [], []
    for k, sheet in enumerate(sheets):
        rng = np.random.default_rng([seed, k])
        drawn = rng.random((50 * max(probes, 1), sheet.states.ndim))
        cell = np.minimum((drawn * ground.side).astype(int), ground.side - 1)
        states = sheet.states[tuple(cell.T)]
        kept = np.flatnonzero((states == HOLDS) | (states == FAILS))
        kept = kept[:len(range(k, probes, len(sheets)))]
        places += [(k, *drawn[place].tolist()) for place in kept]
        expected += states[kept].tolist()
    if not places:
        return ""
    got = ground.answers(places)
    wrong = [place for place, one, other in zip(places, got, expected, strict=True) if one != other]
    most = 100 * wilson(len(wrong), len(places))[1]
    if not wrong:
        return (f"{len(places)} random points in decided cells answer as these do: less than "
                f"{most:.0f} % of them is missed (95 %)")
    points = ground.space.points(ground.shares(wrong[:1]))
    return (f"{len(wrong)} of {len(places)} random points in decided cells answer otherwise, as at "
            f"{', '.join(f'{path} = {value}' for path, value in points[0].items())}: the coarse "
            f"grid missed up to {most:.0f} % of them (95 %), a finer one finds more")


def _again(ground: _Ground, found: Divided) -> tuple[bool, str]:
    """Whether the boundary is where it was at half the step, or less than a cell from it."""
    edges = found.crossed
    chosen = [edges[k] for k in sorted(set(np.linspace(0, len(edges) - 1, AGAIN).astype(int)))] \
        if edges else []
    if not chosen:
        known = sorted(found.answers)
        nodes = [known[k] for k in sorted(set(np.linspace(0, len(known) - 1, AGAIN).astype(int)))]
        same = sum(one == found.answers[node] for one, node in
                   zip(ground.ask(nodes, halved=True), nodes, strict=True))
        return same == len(nodes), f"{same} of {len(nodes)} points answer as before"
    here = _as_before(ground, found, chosen, chosen)
    moved = [edge for edge, same in zip(chosen, here, strict=True) if not same]
    near = _as_before(ground, found, moved, [_wider(edge, ground.side) for edge in moved])
    if all(near):
        return True, (f"{sum(here)} of {len(chosen)} places of the boundary are as before" + (
            ", the others less than a cell away" if moved else ""))
    return False, (f"{near.count(False)} of {len(chosen)} places of the boundary move by more than "
                   "a cell")


def _as_before(
    ground: _Ground, found: Divided, edges: Sequence[Edge], ends: Sequence[Edge],
) -> list[bool]:
    """Whether at half the step ends answer as those of edges did."""
    nodes = sorted({node for edge in ends for node in edge})
    got = dict(zip(nodes, ground.ask(nodes, halved=True), strict=True))
    return [(got[end[0]], got[end[1]]) == (found.answers[edge[0]], found.answers[edge[1]])
            for edge, end in zip(edges, ends, strict=True)]


def _wider(edge: Edge, side: int) -> Edge:
    """An edge that reaches one length farther on both sides, as far as the map goes."""
    (sheet, *one), (_, *other) = edge
    low = (sheet, *(max(a - (b - a), 0) for a, b in zip(one, other, strict=True)))
    high = (sheet, *(min(b + (b - a), side) for a, b in zip(one, other, strict=True)))
    return low, high
