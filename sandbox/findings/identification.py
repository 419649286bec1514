"""Identification: a finger's springs and damping back from a noisy measurement of its motion.

The measurement is a run of ``finger_swing`` with noise put on, so that the truth is known. Some
fits are done as a user would do them; thousands more, for the share of intervals that hold the
truth, on a surface of second order through runs about it (:mod:`sandbox.findings.surface`), with
which the former are compared.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.intervals import Intervals, save_intervals
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.findings.surface import Surface, points_of_surface, surface_of
from sandbox.numeric import Array, Integers
from sandbox.scene.library import shipped_studies
from sandbox.search.asking import Where, asking
from sandbox.search.fitting import Fitted, find_fit, find_fits
from sandbox.search.least_squares import Estimated, estimate, following
from sandbox.search.logistic import wilson
from sandbox.search.measured import Measurements
from sandbox.search.question import Question, asked
from sandbox.sweeps.job import ReadAt

STUDY, SCENE = "identification", "finger_swing"
ANGLES = ("finger.mcp.angle", "finger.pip.angle", "finger.dip.angle")
TIP = ("tip_x", "tip_y")
FINE = 127
"""Instants of the surface, 2.5 ms apart; ..."""
EVERY = 4
"""... every so many of them are measured."""
NOISE, TIP_NOISE = np.radians(0.5), 0.5e-3
"""Standard deviation of a measured angle [rad] and of the place of the tip [m]."""
FITS, MANY, SHOWN = 12, 1000, 30
"""Fits over runs, over the surface, and of these in the picture of intervals."""
LASTING = 0.7
"""Correlation of one measured angle's noise with the next one's, where it is not independent."""
STEPS = np.array([0.04, 0.012, 0.006, 0.08, 0.06, 0.06])
"""Of the surface, in ranges: some two standard deviations of the estimates."""
LEVELS = (0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99)
NOISES, EVERIES = np.radians([0.1, 0.2, 0.5, 1.0]), (16, 4, 1)
"""Of the picture of widths: noise [rad], and every so many instants are measured."""
Z = 1.959964
"""Standard deviations of a normal 95 % interval to each side."""
COVERED, ESTIMATES = "coverage.csv", "estimates.csv"
CALLED = ("stiffness 1", "stiffness 2", "stiffness 3", "damping 1", "damping 2", "damping 3")
"""The parameters in words, joints counted from the knuckle."""


@dataclass(frozen=True)
class Tries:
    """Estimates of many noises, in SI."""

    values: Array
    """[n, p]."""
    halves: Mapping[float, Array]
    """Of the intervals of each of :data:`LEVELS`, [n, p]."""
    told: Array
    """Whether the fit says that what is left is no noise, [n]."""

    def covered(self, truth: Array, level: float = 0.95) -> Array:
        """How many intervals of a level hold the truth, [p]."""
        return np.asarray((np.abs(self.values - truth) <= self.halves[level]).sum(axis=0))


def run(
    directory: Path, *, progress: Callable[[float], None] | None = None, workers: int = 0,
    cluster: str = "",
) -> str:
    """Fit, write pictures and tables; a few lines on what came out.

    Raises:
        OutputError: a file cannot be written.
        SandboxError: no workers, or a cluster that cannot be used; scipy is not installed.
    """
    def further(share: float) -> None:
        if progress is not None:
            progress(share)

    place = Where(workers=workers, cluster=cluster)
    question = asked(str(shipped_studies()[STUDY]))
    surface = surface_about_truth(question, replace(place, out=directory / "surface"))
    further(0.05)
    rows = measured_rows(EVERY)
    white = tries(question, surface.only(rows), independent)
    lasting = tries(question, surface.only(rows), correlated)
    further(0.15)
    fits = []
    for fit in find_fits(question, [measurement(surface.only(rows), seed) for seed in range(FITS)],
                         place=replace(place, out=directory / "fits")):
        fits.append(fit)
        further(0.15 + 0.7 * len(fits) / FITS)
    blind = {}
    for name in BLIND:
        blind[name] = blind_fit(name, question, surface, directory, place)
        further(0.85 + 0.15 * len(blind) / len(BLIND))
    truth = truth_of(question)
    _draw(directory, question, surface, fits, white, lasting)
    write_atomic(directory / COVERED, covered_table(truth, white, lasting))
    write_atomic(directory / ESTIMATES, estimates_table(truth, fits))
    return summary(question, surface, fits, white, lasting, blind)


def truth_of(question: Question) -> Array:
    """The parameters of the scene, SI, in the order of the question's paths, [p]."""
    given = question.plan.loaded.scene.parameters
    return np.array([given[path.removeprefix("parameters.")] for path in question.space.paths])


def shares_of(question: Question, values: Array) -> Array:
    """Shares of the ranges of numbers in SI, [p]; the ranges are even."""
    low, high = question.space.numbers(np.array([np.zeros(len(values)), np.ones(len(values))]))
    return np.asarray((values - low) / (high - low))


def times(every: int = 1) -> Array:
    """Instants at which is measured [s]."""
    return np.asarray(2.5e-3 * np.arange(every, FINE + 1, every), dtype=float)


def measured_rows(every: int) -> Integers:
    """Which numbers of the surface are the angles at :func:`times` of ``every``."""
    one = np.arange(every - 1, FINE, every)
    return np.concatenate([one + k * FINE for k in range(len(ANGLES))])


def surface_about_truth(question: Question, place: Where) -> Surface:
    """What runs near the truth measure: angles, then the place of the tip, each at all times."""
    keep = {f"{name} @ {row}": ReadAt(quantity=name, time=float(time))
            for name in (*ANGLES, *TIP) for row, time in enumerate(times())}
    plan = replace(question.plan, job=replace(question.plan.job, keep=keep))
    centre = shares_of(question, truth_of(question))
    with asking(replace(question, plan=plan), place) as work:
        values = work.values(list(keep), points_of_surface(centre, STEPS))
    return surface_of(values, centre, STEPS)


def independent(rng: np.random.Generator, count: int) -> Array:
    """Noise of one column, of standard deviation 1, [count]."""
    return np.asarray(rng.normal(size=count))


def correlated(rng: np.random.Generator, count: int) -> Array:
    """The same, each number correlated with the one before it by :data:`LASTING`."""
    found = rng.normal(size=count).tolist()
    for row in range(1, count):
        found[row] = LASTING * found[row - 1] + np.sqrt(1 - LASTING**2) * found[row]
    return np.array(found)


Noise = Callable[[np.random.Generator, int], Array]


def noisy(surface: Surface, seed: int, noise: Noise, size: float, columns: int) -> Array:
    """What is measured of a finger that moves as at the surface's centre, [m]."""
    rng = np.random.default_rng(seed)
    count = len(surface.value) // columns
    return np.asarray(surface.value + size * np.concatenate(
        [noise(rng, count) for _ in range(columns)]))


def measurement(surface: Surface, seed: int) -> Measurements:
    """The angles with noise, as a file would hold them."""
    values = noisy(surface, seed, independent, NOISE, len(ANGLES)).reshape(len(ANGLES), -1)
    return Measurements(f"seed {seed}", times(EVERY), dict(zip(ANGLES, values, strict=True)))


def columns_of(surface: Surface, count: int = len(ANGLES)) -> Integers:
    """The column of each number, [m]."""
    return np.repeat(np.arange(count), len(surface.value) // count)


def tries(
    question: Question, surface: Surface, noise: Noise, *, size: float = NOISE,
    count: int = MANY,
) -> Tries:
    """Fits to many noises, over the surface."""
    low, high = question.space.numbers(np.array([np.zeros(6), np.ones(6)]))
    columns = columns_of(surface)
    found: list[Estimated] = [
        estimate(surface, noisy(surface, seed, noise, size, len(ANGLES)), columns, surface.centre)
        for seed in range(count)]
    return Tries(
        low + np.array([each.shares for each in found]) * (high - low),
        {level: np.array([each.halves_at(level) for each in found]) * (high - low)
         for level in LEVELS},
        np.array([bool(following(each.residuals, columns)) for each in found]))


BLIND: Mapping[str, str] = {
    "pull": "the pull is not known either",
    "tip": "only the tip is seen",
    "slow": "ten times as slow"}
"""Measurements that tell less, and what they are."""


def blind_fit(
    name: str, question: Question, surface: Surface, directory: Path, place: Where,
) -> Fitted:
    """A fit to a measurement that tells less, by its name in :data:`BLIND`."""
    over: dict[str, Any] = {  # of which the plan tries both ends
        path: {word: value for word, value in each.items() if word != "count"}
        for path, each in question.plan.written["vary"][0]["over"].items()}
    rows = measured_rows(EVERY)
    at, size = times(EVERY), NOISE
    columns: tuple[str, ...] = ANGLES
    changed: dict[str, Any] = {}
    if name == "pull":
        over["parameters.pull"] = {"from": "3 N", "to": "8 N"}
    elif name == "tip":
        rows, columns, size = rows[:2 * len(at)] + len(ANGLES) * FINE, TIP, TIP_NOISE
    else:
        changed = {"parameters.over": "0.3 s", "parameters.until": "1.5 s",
                   "run.duration": "3.2 s", "run.step": "2 ms", "run.sample_rate": 500}
    other = asked(SCENE, vary=over, keep=[], set=changed)
    if changed:
        at = 10 * at
        surface = _slow(other, at, replace(place, out=directory / "slow_run"))
        rows = np.arange(len(surface.value))
    values = noisy(surface.only(rows), 0, independent, size, len(columns))
    data = directory / f"measured_{name}.csv"
    write_atomic(data, comma_separated(
        ["time", *columns], np.column_stack([at, *values.reshape(len(columns), -1)])))
    return find_fit(other, data, place=replace(place, out=directory / name))


def _slow(question: Question, at: Array, place: Where) -> Surface:
    """The one run of the truth, ten times as slow."""
    keep = {f"{name} @ {row}": ReadAt(quantity=name, time=float(time))
            for name in ANGLES for row, time in enumerate(at)}
    plan = replace(question.plan, job=replace(question.plan.job, keep=keep))
    centre = shares_of(question, truth_of(question))
    with asking(replace(question, plan=plan), place) as work:
        value = work.values(list(keep), centre[None])[0]
    return Surface(centre, value, np.zeros((len(value), 6)), np.zeros((len(value), 6, 6)))


def widths(surface: Surface, size: float, every: int) -> Array:
    """Half of each 95 % interval in ranges, closed form 1.96 sigma sqrt(diag (J'J)^-1), [p]."""
    slopes = surface.only(measured_rows(every)).slopes
    return np.asarray(Z * size * np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes))))


def covered_table(truth: Array, white: Tries, lasting: Tries) -> str:
    """Which share of intervals holds the truth: noise, level, parameter, share, its interval."""
    rows: list[list[object]] = []
    for kind, found in (("independent", white), ("lasting", lasting)):
        count = len(found.values)
        for level in LEVELS:
            for name, held in zip(CALLED, found.covered(truth, level).tolist(),
                                  strict=True):
                rows.append([kind, level, name, held / count, *wilson(held, count)])
    return comma_separated(["noise", "level", "parameter", "share", "low", "high"], rows)


def estimates_table(truth: Array, fits: Sequence[Fitted]) -> str:
    """What each fit over runs found, SI."""
    return comma_separated(
        ["measurement", "parameter", "truth", "value", "low", "high", "halved"],
        ([seed, name, true, each.value, each.low, each.high, each.halved]
         for seed, fit in enumerate(fits)
         for name, true, each in zip(CALLED, truth.tolist(), fit.parameters, strict=True)))


def _draw(
    directory: Path, question: Question, surface: Surface, fits: Sequence[Fitted], white: Tries,
    lasting: Tries,
) -> None:
    truth = truth_of(question)
    for ending in ("png", "svg", "pdf"):
        save_panels(directory / f"identification_motion.{ending}",
                    [_motion(question, surface, fits[0])])
        save_intervals(directory / f"identification_intervals.{ending}",
                       [_intervals(k, truth, white) for k in range(len(CALLED))],
                       count="measurements")
        save_panels(directory / f"identification_coverage.{ending}",
                    [_coverage(truth, white, lasting), _widths(question, surface, truth)])


def _motion(question: Question, surface: Surface, fit: Fitted) -> Panel:
    """What was measured first, and what the fitted finger does."""
    shares = shares_of(question, np.array([each.value for each in fit.parameters]))
    angles = surface.only(measured_rows(1))
    fitted = np.degrees(angles(shares[None])[0].reshape(len(ANGLES), -1))
    seen = measurement(surface.only(measured_rows(EVERY)), 0)
    curves = []
    for name, angle, values in zip(("knuckle", "middle joint", "end joint"), fitted,
                                   seen.columns.values(), strict=True):
        curves += [Curve(f"{name}, fitted", times(), angle),
                   # with a nan at its end no point of a curve is left out for its neighbours
                   Curve(f"{name}, measured", np.append(seen.time, np.nan),
                         np.degrees(np.append(values, np.nan)), "points")]
    return Panel("A finger that is pulled and let go", "time [s]", "angle [deg]", curves)


def _intervals(k: int, truth: Array, white: Tries) -> Intervals:
    factor, unit = (1e-3, "[kN/m]") if k < 3 else (1e3, "[N mm s/rad]")
    values, halves = (factor * each[:SHOWN, k] for each in (white.values, white.halves[0.95]))
    return Intervals(CALLED[k], unit, values, values - halves, values + halves,
                     factor * float(truth[k]))


def _coverage(truth: Array, white: Tries, lasting: Tries) -> Panel:
    curves = [Curve("what they say", np.array([50.0, 100.0]), np.array([50.0, 100.0]), "dashed")]
    for name, found in (("independent noise", white), ("noise that lasts", lasting)):
        shares = np.array([100 * found.covered(truth, level) / len(found.values)
                           for level in LEVELS])
        curves.append(Curve(f"{name}: least and most of six", np.tile(100 * np.array(LEVELS), 2),
                            np.concatenate([shares.min(axis=1), shares.max(axis=1)]), "points"))
    return Panel("Do intervals hold the truth as often as they say?", "they say [%]",
                 "they do [%]", curves)


def _widths(question: Question, surface: Surface, truth: Array) -> Panel:
    """Half of an interval over the noise, for several numbers of instants; of the last damping."""
    k = len(CALLED) - 1
    low, high = question.space.numbers(np.array([np.zeros(6), np.ones(6)]))
    scale = 100 * float((high[k] - low[k]) / truth[k])
    curves = []
    for every in EVERIES:
        name = f"{len(times(every))} instants"
        closed = np.array([widths(surface, size, every)[k] for size in NOISES])
        some = [tries(question, surface.only(measured_rows(every)), independent, size=size,
                      count=40) for size in NOISES]
        found = np.array([each.halves[0.95][:, k].mean() for each in some]) / (high[k] - low[k])
        curves += [Curve(f"{name}, closed form", np.degrees(NOISES), scale * closed),
                   Curve(f"{name}, fits", np.degrees(NOISES), scale * found, "points")]
    return Panel("How sure the end joint's damping is", "noise of a measured angle [deg]",
                 "half of the 95 % interval [%]", curves, scale="log")


def summary(
    question: Question, surface: Surface, fits: Sequence[Fitted], white: Tries, lasting: Tries,
    blind: Mapping[str, Fitted],
) -> str:
    """What came out, in a few lines."""
    truth, count = truth_of(question), len(white.values)
    held = white.covered(truth)
    low, high = wilson(int(held.min()), count)[0], wilson(int(held.max()), count)[1]
    there = sum(each.low <= true <= each.high for fit in fits
                for each, true in zip(fit.parameters, truth, strict=True))
    found = np.array([[each.value for each in fit.parameters] for fit in fits])
    off = np.abs(found - white.values[:len(fits)]) / white.halves[0.95][:len(fits)]
    ends = question.space.numbers(np.array([np.zeros(6), np.ones(6)]))
    form = widths(surface, NOISE, EVERY) * (ends[1] - ends[0])
    spread = Z * white.values.std(axis=0) / form
    short = lasting.covered(truth) / count
    sure = 100 * form / truth
    return "\n".join([
        f"{len(fits)} fits over runs ({sum(fit.runs for fit in fits)} new runs): {there} of "
        f"{len(fits) * len(CALLED)} intervals hold the truth, {sum(f.certified for f in fits)} "
        "certificates hold.",
        f"{count} fits over the surface: of each parameter's 95 % intervals "
        f"{100 * held.min() / count:.1f} to {100 * held.max() / count:.1f} % hold the truth "
        f"(95 % sure: {100 * low:.1f} to {100 * high:.1f} %). The two kinds of fits differ by at "
        f"most {100 * off.max():.1f} % of half an interval.",
        "Half of the intervals [%]: "
        + ", ".join(f"{name} {each:.1f}" for name, each in zip(CALLED, sure, strict=True))
        + f"; the estimates scatter {spread.min():.2f} to {spread.max():.2f} times as much as "
        "sigma (J'J)^-1/2 says.",
        f"Noise that lasts: {100 * short.min():.0f} to {100 * short.max():.0f} % hold the truth, "
        f"{100 * lasting.told.mean():.0f} % of the fits say so, and "
        f"{100 * white.told.mean():.1f} % of those to independent noise.",
        *(f"{BLIND[name]}: half of the intervals [%] "
          + ", ".join(f"{100 * (each.high - each.low) / 2 / true:.3g}" for each, true in
                      zip(fit.parameters, truth, strict=False))
          + "".join(f"; {line}" for line in fit.lines if line.startswith("the data can't tell"))
          for name, fit in blind.items())])
