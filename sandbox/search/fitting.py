"""Identification: values of paths with which a scene reproduces a measurement.

The estimate is the maximum likelihood for independent normal noise, whose size may differ between
columns and is estimated too. Intervals are those of the model linearised at the estimate (Seber
and Wild, Nonlinear Regression, 1989, ch. 5).
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sandbox.atomic_files import write_csv
from sandbox.errors import SandboxError
from sandbox.figure import style
from sandbox.figure.panels import Axis, Curve, Panel, draw
from sandbox.model.catalogue import Catalogue
from sandbox.numeric import Array, Integers
from sandbox.scene.settings import Looked
from sandbox.search.session import FOUND, RefusedError, Result, Session, results
from sandbox.sweeps.options import FitSearch
from sandbox.sweeps.spec import Distribution
from sandbox.values.units import factor_of
from sandbox.wording import WrongValueError, listed, or_near, quoted

COMPARED = "fit.csv"
MAX_NUMBERS = 2_000  # measured numbers that are compared
MAX_PANELS = 6  # columns in the figure; all are in ``fit.csv``
TIMES = ("time", "t", "time_s", "t_s")  # names of the column of times
STARTS = 8  # points spread over the ranges; the fit starts at the best of them
DIFFERENCE = 1e-3  # half the distance of the runs of a central difference, of the range
SLOPE = 1e-5  # of quantiles: half the distance at which the slope of a path's value is computed
MAX_ROUNDS = 8  # repetitions with newly estimated noise
SETTLED = 0.02  # relative change of the noise at which repetitions end
TOLERANCE = 1e-8  # relative decrease of the sum of squares at which the optimisation ends
RANK = 1e-9  # relative singular value of the Jacobian below which a direction is not determined
UNCERTAIN = 0.5  # half of a 95 % interval, in ranges, that does not determine a direction
CORRELATED = 3.0  # Standard errors of the correlation of neighbouring residuals that are no noise
SAME = 0.25  # of half an interval: change of the parameters at half the step that is accepted
_UNIT = re.compile(r"\s*(.*?)\s*\[([^\[\]]+)\]\s*")
Model = Callable[[Array], Array]  # quantiles [n, p] to predicted numbers [n, m]


@dataclass(frozen=True)
class Parameter:
    """The estimate of one path."""

    path: str
    unit: str  # SI; empty for none
    value: float  # SI
    low: float  # of the 95 % interval, SI
    high: float
    at_end: bool  # whether it is at an end of its range: the best may lie beyond
    halved: float  # the estimate at half the step, SI


@dataclass(frozen=True, repr=False)
class Fitted(Result):
    """Parameters fitted to a measurement."""

    parameters: tuple[Parameter, ...]
    noise: Mapping[str, float]  #: standard deviation of each column's noise, SI, estimated or given
    blind: tuple[tuple[float, Mapping[str, float]], ...]
    """Undetermined directions: half of the 95 % interval, and the share of each path, in ranges."""
    count: int  #: measured numbers
    remarks: tuple[str, ...] = ()

    def __getitem__(self, path: str) -> Parameter:
        """The parameter of a path."""
        return next(each for each in self.parameters if each.path == path)

    def _lines(self) -> list[str]:
        lines = [f"{each.path} = {each.value:.6g} {each.unit}".rstrip()
                 + f"  (95 % interval {each.low:.6g} to {each.high:.6g})"
                 + ("  at an end of its range" if each.at_end else "")
                 for each in self.parameters]
        lines += [f"noise of {name}: {size:.4g}" for name, size in self.noise.items()]
        for half, parts in self.blind:
            direction = ", ".join(f"{part:+.2f} {path}" for path, part in parts.items()
                                  if abs(part) > 0.1)
            size = f"± {half:.3g} ranges" if math.isfinite(half) else "not at all"
            lines.append(f"the data do not determine: {direction} ({size})")
        return [*lines, *self.remarks]


class BadDataError(RefusedError):
    """A measurement that cannot be used."""

    code = "bad-measurements"


class Measurement(NamedTuple):
    """Measured numbers in a row, [m], and the results of a run that predict them."""

    units: dict[str, str]  # SI, by column
    keep: dict[str, Looked]
    time: Array  # [s]
    data: Array  # SI
    columns: Integers  # index of the column of each number


def read_columns(path: Path) -> tuple[Array, dict[str, Array]]:
    """Times [s] and columns [SI] such as ``x [mm]`` of a CSV file, [n]; nan for empty cells."""
    def bad(why: str, row: int = 0) -> BadDataError:
        return BadDataError(f"{path}{f', row {row}:' if row else ''} {why}", "data")

    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", "") or "it is not UTF-8 text"
        raise bad(f"cannot be read: {why}") from None
    head, *rows = [row for row in csv.reader(lines) if any(map(str.strip, row))] or [[]]
    if not rows:
        raise bad("has no measurements: expected a line of names, then numbers")
    names, factors = [], []
    for cell in head:
        match = _UNIT.fullmatch(cell)
        names.append(match[1] if match else cell.strip())
        try:
            factors.append(factor_of(match[2].strip(), None) if match else 1.0)
        except WrongValueError as error:
            raise bad(str(error), 1) from None
    time = next((k for k, name in enumerate(names) if name.lower() in TIMES), None)
    if time is None:
        raise bad(f"has no column of times (allowed: {', '.join(TIMES)}; it has {listed(names)})")
    if len(set(names)) < len(names):
        raise bad("has two columns with the same name")
    cells = np.full((len(rows), len(names)), np.nan)
    for number, row in enumerate(rows):
        if len(row) != len(names):
            raise bad(f"{len(row)} cells under {len(names)} names", number + 2)
        for k, cell in enumerate(row):
            try:
                cells[number, k] = factors[k] * float(cell.strip() or "nan")
            except ValueError:
                raise bad(f"{quoted(cell)} is no number", number + 2) from None
    if np.isnan(cells[:, time]).any():
        raise bad("has a row without a time")
    return cells[:, time], {name: cells[:, k] for k, name in enumerate(names) if k != time}


def _measurement(session: Session, path: Path, match: Mapping[str, str] | None) -> Measurement:
    time, columns = read_columns(path)
    mechanism = session.plan.loaded.mechanism
    catalogue = Catalogue(mechanism)
    pairs = match if match is not None else {name: name for name in columns if name in catalogue}
    if not pairs:
        raise RefusedError(f"no column of {path} has the name of a quantity: assign one, as in "
                           f"x=puck.x (columns: {listed(columns)})")
    for name, quantity in pairs.items():
        if name not in columns:
            raise BadDataError(f"{path} has no column {quoted(name)}{or_near(name, columns)} (it "
                               f"has {listed(columns)})")
        if quantity not in catalogue:
            hint = catalogue.near(quantity)
            raise RefusedError(f"no run has the quantity {quoted(quantity)}"
                               f"{f'; did you mean {quoted(hint)}?' if hint else ''}")
    values = np.stack([columns[name] for name in pairs])
    places, rows = np.nonzero(np.isfinite(values))
    if not 0 < len(rows) <= MAX_NUMBERS:
        raise BadDataError(f"{path} has {len(rows)} numbers in {listed(pairs)} (allowed: 1 to "
                           f"{MAX_NUMBERS})")
    if not (time.min() >= 0 and time.max() <= mechanism.run.duration + 1e-9):
        raise BadDataError(f"{path} has times from {time.min():g} to {time.max():g} s, the run "
                           f"from 0 to {mechanism.run.duration:g} s")
    names = list(pairs)
    return Measurement(
        {name: catalogue.find(quantity).unit for name, quantity in pairs.items()},
        {f"{names[k]} @ {row}": Looked(of=pairs[names[k]], at=float(time[row]))
         for k, row in zip(places.tolist(), rows.tolist(), strict=True)},
        time[rows], values[places, rows], places)


class Estimate(NamedTuple):
    """Parameters as quantiles of their ranges."""

    quantiles: Array  # [p]
    noise: Array  # standard deviation of each column, SI
    residuals: Array  # model less data, [m]
    halves: Array  # half of each 95 % interval, in ranges, [p]; inf where nothing is determined
    blind: list[tuple[float, Array]]  # see Fitted; unit vectors [p]


def estimate(
    model: Model, data: Array, columns: Integers, start: Array, *, noise: Array | None = None,
) -> Estimate:
    """The maximum likelihood estimate from ``start`` [p]; ``columns`` [m] are those of ``data``."""
    from scipy import optimize, stats
    freedom = len(data) - len(start)
    if freedom <= 0:
        raise BadDataError(f"{len(data)} measured numbers do not determine {len(start)} parameters")
    differences = _differences(model)
    sizes = _spreads(data, columns) if noise is None else noise
    quantiles = start
    for _ in range(MAX_ROUNDS):
        weights = 1 / sizes[columns]
        quantiles = optimize.least_squares(
            lambda at, weights=weights: weights * (differences(at)[0] - data), quantiles,
            jac=lambda at, weights=weights: weights[:, None] * differences(at)[1],
            bounds=(0.0, 1.0), ftol=TOLERANCE, xtol=1e-8, gtol=1e-10, max_nfev=60).x
        residuals = differences(quantiles)[0] - data
        if noise is not None:
            break
        before, sizes = sizes, np.maximum([
            np.sqrt(np.mean(residuals[columns == k] ** 2) * len(data) / freedom)
            for k in range(len(sizes))], 1e-12 * _spreads(data, columns))
        if np.all(np.abs(sizes - before) <= SETTLED * before):
            break
    jacobian = differences(quantiles)[1] / sizes[columns][:, None]
    _, values, rows = np.linalg.svd(jacobian, full_matrices=False)  # for (J^T J)^-1
    known = values > RANK * values[0] if values[0] > 0 else np.zeros(len(values), bool)
    factor = float(stats.t.ppf(0.975, freedom if noise is None else math.inf))
    halves = np.where(known, factor / np.where(known, values, 1.0), np.inf)
    with np.errstate(invalid="ignore"):
        parts = np.where(np.abs(rows) > (0.0 if known.all() else 1e-6),
                         (rows * halves[:, None]) ** 2, 0.0)
    blind = [(float(half), row * np.sign(row[np.argmax(np.abs(row))]))
             for half, row in zip(halves, rows, strict=True) if half > UNCERTAIN]
    return Estimate(quantiles, sizes, residuals, np.sqrt(parts.sum(axis=0)), blind)


def _differences(model: Model) -> Callable[[Array], tuple[Array, Array]]:
    """A model and its Jacobian by central differences; the last point is kept."""
    @lru_cache(maxsize=1)
    def differences(point: bytes) -> tuple[Array, Array]:
        at = np.frombuffer(point)
        steps = DIFFERENCE * np.eye(len(at))
        low, high = np.clip(at - steps, 0, 1), np.clip(at + steps, 0, 1)
        found = model(np.concatenate([at[None], low, high]))
        if not np.isfinite(found).all():
            raise SandboxError("a run on the way has no values", code="no-answer")
        middle, low_values, high_values = np.split(found, [1, 1 + len(at)])
        return middle[0], ((high_values - low_values) / np.diagonal(high - low)[:, None]).T

    return lambda at: differences(at.tobytes())


def _spreads(data: Array, columns: Integers) -> Array:
    return np.array([np.std(data[columns == k]) or 1.0 for k in range(columns.max() + 1)])


def find_fit(session: Session, options: FitSearch) -> Fitted:
    """The values of paths with which the scene reproduces a measurement, and their uncertainty."""
    from scipy.stats import qmc
    if others := session.of_kind(tuple, Distribution):
        raise RefusedError("a fit varies paths with ranges, as in '2 N:8 N'; "
                           f"{quoted(others[0])} has none")
    measured, sizes = _measurement(session, Path(options.data), options.match), None
    if options.noise is not None:
        if options.noise.keys() != measured.units.keys():
            raise RefusedError("give the noise of each column, or of none: "
                               f"{listed(measured.units)}", "noise")
        for name, unit in measured.units.items():
            session.check_unit(options.noise[name], unit, f"the noise of {name}", "noise")
        sizes = np.array([options.noise[name] for name in measured.units])
    session.job = replace(session.job, keep={**session.job.keep, **measured.keep})

    def model(quantiles: Array, *, halved: bool = False) -> Array:
        return results(session.rows(quantiles, halved=halved), measured.keep)

    points = np.vstack([
        np.full(len(session.paths), 0.5),
        qmc.Halton(len(session.paths), scramble=False).random(STARTS + 1)[1:]])
    spread = _spreads(measured.data, measured.columns)[measured.columns]
    misfit = (((model(points) - measured.data) / spread) ** 2).sum(axis=1)
    if not np.isfinite(misfit).any():
        raise SandboxError("no run of those at the start has all values that were measured",
                           code="no-answer")
    found = estimate(model, measured.data, measured.columns, points[int(np.nanargmin(misfit))],
                     noise=sizes)
    again = estimate(lambda quantiles: model(quantiles, halved=True), measured.data,
                     measured.columns, found.quantiles, noise=found.noise)
    fitted = _fitted(session, measured, found, again)
    session.write(fitted)
    if session.out:
        table = np.stack([measured.time, measured.data, measured.data + found.residuals], axis=1)
        columns = {name: table[measured.columns == k] for k, name in enumerate(measured.units)}
        write_csv(session.out / COMPARED, [
            ("column", "time_s", "measured", "fitted"),
            *((name, *row) for name, rows in columns.items() for row in rows.tolist())])
        panels = []
        for name, (time, data, model_data) in [
                (name, rows.T) for name, rows in columns.items()][:MAX_PANELS]:
            how = style.shown_as(measured.units[name], data, model_data)
            panels.append(Panel(
                name, Axis("time [s]"), Axis(how.label(name)),
                [Curve("measured", time, how.factor * data, "points"),
                 Curve("fitted", time, how.factor * model_data)]))
        style.save_figure(draw(panels), session.out / FOUND)
    return fitted


def _fitted(session: Session, measured: Measurement, found: Estimate, again: Estimate) -> Fitted:
    values, halved = session.numbers(np.stack([found.quantiles, again.quantiles])).tolist()
    ends = np.clip([found.quantiles - SLOPE, found.quantiles + SLOPE], 0, 1)
    low, high = session.numbers(ends)
    halves = np.abs((high - low) / (ends[1] - ends[0]) * found.halves).tolist()
    parameters = tuple(Parameter(
        path, session.units[path], values[k], values[k] - halves[k], values[k] + halves[k],
        min(found.quantiles[k], 1 - found.quantiles[k]) < 1e-6, halved[k])
        for k, path in enumerate(session.paths))
    known = np.isfinite(found.halves)
    moved = np.abs(again.quantiles - found.quantiles)[known]
    worst = float((moved / np.maximum(found.halves[known], 1e-300)).max(initial=0.0))
    remarks = []
    for k, name in enumerate(measured.units):
        residuals = found.residuals[measured.columns == k]
        residuals -= residuals.mean()
        if len(residuals) > 10 and (total := float(residuals @ residuals)) > 0:
            correlation = float(residuals[1:] @ residuals[:-1]) / total
            # that of n independent numbers has a standard error of 1 / sqrt(n)
            if correlation * math.sqrt(len(residuals)) > CORRELATED:
                remarks.append(f"the residuals of {name} are not random (neighbours correlate by "
                               f"{correlation:.2f}): the model is incomplete, and intervals are "
                               "too narrow")
    return Fitted(
        parameters, dict(zip(measured.units, found.noise.tolist(), strict=True)),
        tuple((half, dict(zip(session.paths, row.tolist(), strict=True)))
              for half, row in found.blind),
        len(measured.data), tuple(remarks), runs=len(session.visited) + len(session.halved),
        certified=bool(known.any()) and worst <= SAME,
        certificate=f"no parameter moves by more than {worst:.2g} of half its interval")
