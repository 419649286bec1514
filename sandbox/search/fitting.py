"""Identification: the parameters of a scene with which it moves as was measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.errors import SandboxError
from sandbox.model.catalogue import Catalogue
from sandbox.numeric import Array, Integers
from sandbox.search.asking import FOUND, Asking, Where, asking
from sandbox.search.criteria import RefusedError, measures_as
from sandbox.search.fit_figure import FittedColumn, draw_fit
from sandbox.search.least_squares import DIFFERENCE, Estimated, estimate, following
from sandbox.search.measured import Measurements, read_measured
from sandbox.search.question import Question
from sandbox.sweeps.job import Asked, ReadAt, SweepRow
from sandbox.wording import listed, quoted, told_of

COMPARED = "fit.csv"
STARTS = 8
"""Points spread over the ranges, of which the best is begun at."""
MOST = 2_000
"""Measured numbers that are compared."""
SAME = 0.25
"""Of half an interval: how far the parameters may move at half the step and be the same."""


@dataclass(frozen=True)
class Parameter:
    """What came of one path."""

    path: str
    unit: str
    """SI; empty for none."""
    value: float
    """SI."""
    low: float
    """Of the 95 % interval, SI."""
    high: float
    at_end: bool
    """Whether it is at an end of its range: the best may lie beyond."""
    halved: float
    """The value at half the step, SI."""


@dataclass(frozen=True)
class Fitted:
    """Parameters fitted to what was measured."""

    parameters: tuple[Parameter, ...]
    noise: Mapping[str, float]
    """Standard deviation of each column's noise, SI, estimated or given."""
    blind: tuple[tuple[float, Mapping[str, float]], ...]
    """Directions that the data can't tell: half of the 95 % interval in ranges, and how much each
    path takes part, in shares of its range."""
    count: int
    """Numbers measured."""
    runs: int
    certified: bool
    certificate: str
    remarks: tuple[str, ...] = ()

    def __getitem__(self, path: str) -> Parameter:
        """The parameter of a path."""
        return next(each for each in self.parameters if each.path == path)

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """What was found, for a person."""
        told = [f"{each.path} = {each.value:.6g} {each.unit}".rstrip()
                + f"  (95 % interval {each.low:.6g} to {each.high:.6g})"
                + ("  at an end of its range" if each.at_end else "") for each in self.parameters]
        told += [f"noise of {name}: {size:.4g}" for name, size in self.noise.items()]
        told += [f"the data can't tell: {_direction(parts)} "
                 f"(± {half:.3g} ranges)" if np.isfinite(half) else
                 f"the data can't tell: {_direction(parts)} (not at all)"
                 for half, parts in self.blind]
        return [*told, *self.remarks,
                f"half the step: {'the same' if self.certified else 'NOT the same'}; "
                f"{self.certificate}"]


def _direction(parts: Mapping[str, float]) -> str:
    """``+0.71 a, -0.71 b``: along which way, in shares of ranges, the data leave all open."""
    kept = {path: part for path, part in parts.items() if abs(part) > 0.1}
    return ", ".join(f"{part:+.2f} {path}" for path, part in kept.items())


def find_fit(
    question: Question, data: Path, *, match: Mapping[str, str] | None = None,
    noise: Mapping[str, float] | None = None, difference: float = DIFFERENCE,
    place: Where | None = None,
) -> Fitted:
    """The parameters with which the scene moves as was measured, and how sure they are.

    Args:
        question: paths with ranges.
        data: a CSV file, see :mod:`sandbox.search.measured`.
        match: the quantity that each column is; by default columns that have a quantity's name.
        noise: standard deviation of each column [SI]; estimated by default.
        difference: of the runs of which derivatives are made, in ranges.
        place: where it runs and what it leaves behind.

    Raises:
        RefusedError: paths without ranges, columns or quantities that there are none of.
        SandboxError: no such data, a run without an answer, no scipy.
    """
    _possible(question)
    place = place or Where()
    fitting = _Fitting.of(question, [read_measured(data)], match, noise, difference)
    with fitting.at_work(place) as work:
        fitted, residuals = fitting.fit(work, fitting.sought[0])
        if place.out:
            work.leave(place.out, "fit", {
                **vars(fitted), "parameters": [vars(each) for each in fitted.parameters]},
                data=str(data), match=match, noise=noise)
            fitting.leave(place.out, residuals)
    return fitted


def find_fits(
    question: Question, measured: Sequence[Measurements], *,
    match: Mapping[str, str] | None = None, noise: Mapping[str, float] | None = None,
    difference: float = DIFFERENCE, place: Where | None = None,
) -> Iterator[Fitted]:
    """A fit to each of several measurements, one after the other; they share workers and runs.

    What was found is not left behind, only the runs are. Arguments as of :func:`find_fit`.

    Raises:
        SandboxError: also where not all have the same times, columns and empty cells.
    """
    _possible(question)
    fitting = _Fitting.of(question, measured, match, noise, difference)
    with fitting.at_work(place or Where()) as work:
        for sought in fitting.sought:
            yield fitting.fit(work, sought)[0]


def _possible(question: Question) -> None:
    """Refuse what no fit can vary, and to fit without scipy."""
    space = question.space
    if space.random or space.lists:
        raise RefusedError("a fit varies paths with ranges, as in '2 N:8 N'; "
                           f"{quoted((space.random + space.lists)[0])} has none")
    if find_spec("scipy") is None:
        raise SandboxError("a fit needs scipy: pip install 'sandbox-mechanics[studies]'",
                           code="missing-package")


@dataclass
class _Fitting:
    """What is fitted, to what, and how."""

    question: Question
    sought: Sequence[_Sought]
    pairs: Mapping[str, str]
    """The quantity of each column."""
    units: Mapping[str, str]
    """Of each column, SI."""
    noise: Array | None
    difference: float
    runs: int = 0
    """So far."""

    @staticmethod
    def of(
        question: Question, measured: Sequence[Measurements], match: Mapping[str, str] | None,
        noise: Mapping[str, float] | None, difference: float,
    ) -> _Fitting:
        catalogue = Catalogue(question.plan.loaded.mechanism)
        pairs = _matched(catalogue, measured[0], match)
        sought = [_Sought.of(question, each, pairs) for each in measured]
        for each, one in zip(measured, sought, strict=True):
            if one.keep != sought[0].keep:
                raise SandboxError(f"{each.file} has not the times and columns of "
                                   f"{measured[0].file}: they are not fitted together",
                                   code="bad-measurements")
        if noise is not None and set(noise) != set(pairs):
            raise RefusedError("the noise of each column is said, or of none: "
                               f"{listed(list(pairs))}")
        for name, size in (noise or {}).items():
            measures_as(size, catalogue.find(pairs[name]).unit, f"the noise of {name}")
            if not size > 0:
                raise RefusedError(f"the noise of {name} is greater than 0, not {size:g}")
        sizes = None if noise is None else np.array([noise[name] for name in pairs])
        if sizes is not None and not (sizes > 0).all():
            raise RefusedError("the noise of a column is greater than 0")
        units = {name: catalogue.find(pairs[name]).unit for name in pairs}
        return _Fitting(question, sought, pairs, units, sizes, difference)

    def leave(self, directory: Path, residuals: Array) -> None:
        """Write what was measured beside what the fitted scene does, as a table and a figure."""
        columns = self.sought[0].columns_beside(list(self.pairs), residuals)
        write_atomic(directory / COMPARED, comma_separated(
            ["column", "time_s", "measured", "fitted"],
            ((name, *row) for name, rows in columns.items() for row in rows.tolist())))
        draw_fit(directory / FOUND, [FittedColumn(name, self.units[name], *rows.T)
                                     for name, rows in columns.items()])

    def at_work(self, place: Where) -> AbstractContextManager[Asking]:
        """The search, as a context, with what is measured kept of each run."""
        job = self.question.plan.job
        plan = replace(self.question.plan, job=replace(
            job, keep={**job.keep, **self.sought[0].keep}))

        def count(row: SweepRow) -> None:
            self.runs += 1
            if place.heard:
                place.heard(row)

        return asking(replace(self.question, plan=plan), replace(place, heard=count))

    def fit(self, work: Asking, sought: _Sought) -> tuple[Fitted, Array]:
        """What was found, and what is left of the data, [m]."""
        before = self.runs
        found = estimate(lambda shares: sought.model(work, shares), sought.data, sought.columns,
                         _start(work, sought), noise=self.noise, difference=self.difference)
        again = estimate(lambda shares: sought.model(work, shares, halved=True), sought.data,
                         sought.columns, found.shares, noise=found.noise,
                         difference=self.difference)
        return (_fitted(self.question, list(self.pairs), sought, found, again, self.runs - before),
                found.residuals)


@dataclass(frozen=True)
class _Sought:
    """Measured numbers in a row, [m], and the readings of a run that they are compared with."""

    keep: Mapping[str, Asked]
    data: Array
    columns: Integers

    @staticmethod
    def of(question: Question, measured: Measurements, pairs: Mapping[str, str]) -> _Sought:
        keep: dict[str, Asked] = {}
        data: list[float] = []
        columns: list[int] = []
        for k, (name, quantity) in enumerate(pairs.items()):
            for row, (time, value) in enumerate(zip(measured.time, measured.column(name),
                                                    strict=True)):
                if np.isfinite(value):
                    keep[f"{name} @ {row}"] = ReadAt(quantity=quantity, time=float(time))
                    data.append(float(value))
                    columns.append(k)
        if not data:
            raise SandboxError(f"{measured.file} has no number in {listed(list(pairs))}",
                               code="bad-measurements")
        if len(data) > MOST:
            raise SandboxError(f"{measured.file} has {len(data)} numbers to be compared (allowed: "
                               f"at most {MOST}); leave every other line out, or more",
                               code="bad-measurements")
        end = question.plan.loaded.mechanism.run.duration
        if not (measured.time.min() >= 0 and measured.time.max() <= end + 1e-9):
            raise SandboxError(
                f"{measured.file} has times from {measured.time.min():g} to "
                f"{measured.time.max():g} s, the run from 0 to {end:g} s", code="bad-measurements")
        return _Sought(keep, np.array(data), np.array(columns, dtype=np.int64))

    def columns_beside(self, names: Sequence[str], residuals: Array) -> dict[str, Array]:
        """Time [s], what was measured and what was fitted of each column, [n, 3]."""
        times = [reading.time for reading in self.keep.values() if isinstance(reading, ReadAt)]
        rows = np.stack([times, self.data, self.data + residuals], axis=1)
        found = {name: rows[self.columns == k] for k, name in enumerate(names)}
        return {name: some for name, some in found.items() if len(some)}

    def model(self, work: Asking, shares: Array, *, halved: bool = False) -> Array:
        """What would be measured at shares [n, p], [n, m]; nan of runs that did not end well."""
        return work.values(list(self.keep), shares, halved=halved)


def _matched(
    catalogue: Catalogue, measured: Measurements, match: Mapping[str, str] | None,
) -> dict[str, str]:
    """The quantity of each column.

    Raises:
        SandboxError: an unknown column.
        RefusedError: an unknown quantity, or none at all.
    """
    if match is None:
        match = {name: name for name in measured.columns if name in catalogue}
        if not match:
            raise RefusedError(f"no column of {measured.file} has the name of a quantity: say "
                               "which is which, as in x=puck.x (columns: "
                               f"{listed(list(measured.columns))})")
    for name, quantity in match.items():
        measured.column(name)
        if quantity not in catalogue:
            hint = catalogue.near(quantity)
            raise RefusedError(f"no run has the quantity {quoted(quantity)}"
                               f"{f'; did you mean {quoted(hint)}?' if hint else ''}")
    return dict(match)


def _start(work: Asking, sought: _Sought) -> Array:
    """The best of some points spread over the ranges."""
    from scipy.stats import qmc

    count = len(work.question.space.paths)
    shares = np.vstack([np.full(count, 0.5), qmc.Halton(count, scramble=False).random(
        STARTS + 1)[1:]])
    spread = np.array([np.std(sought.data[sought.columns == k]) or 1.0
                       for k in range(sought.columns.max() + 1)])[sought.columns]
    misfit = (((sought.model(work, shares) - sought.data) / spread) ** 2).sum(axis=1)
    if not np.isfinite(misfit).any():
        raise SandboxError("no run of those at the start has all values that were measured",
                           code="no-answer")
    return np.asarray(shares[int(np.nanargmin(misfit))])


def _fitted(
    question: Question, names: Sequence[str], sought: _Sought, found: Estimated, again: Estimated,
    runs: int,
) -> Fitted:
    space = question.space
    values, halved = (space.numbers(each.shares[None])[0] for each in (found, again))
    slopes, halves = space.slopes(found.shares), found.halves
    parameters = tuple(_parameter(
        path, space.units[path], float(values[k]), float(slopes[k] * halves[k]),
        float(found.shares[k]), float(halved[k])) for k, path in enumerate(space.paths))
    told = np.isfinite(halves)
    moved = np.abs(again.shares - found.shares)[told]
    certified = bool(told.any() and (moved <= SAME * halves[told]).all())
    worst = float((moved / np.maximum(halves[told], 1e-300)).max(initial=0.0))
    return Fitted(
        parameters, dict(zip(names, found.noise.tolist(), strict=True)),
        tuple((half, dict(zip(space.paths, row.tolist(), strict=True)))
              for half, row in found.blind),
        len(sought.data), runs, certified,
        f"no parameter moves by more than {worst:.2g} of half its interval",
        tuple(_follows(names, sought, found)))


def _parameter(
    path: str, unit: str, value: float, half: float, share: float, halved: float,
) -> Parameter:
    return Parameter(path, unit, value, value - abs(half), value + abs(half),
                     min(share, 1 - share) < 1e-6, halved)


def _follows(names: Sequence[str], sought: _Sought, found: Estimated) -> list[str]:
    """Columns of which residuals follow one another: the model is wrong there, or the noise is."""
    return [f"what is left of {names[k]} is no noise (neighbours correlate by {follow:.2f}): the "
            "scene lacks something, and intervals are too narrow"
            for k, follow in following(found.residuals, sought.columns).items()]
