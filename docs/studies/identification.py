"""A finger's springs and damping back from a noisy measurement of its motion.

The measurement is a run of ``finger_swing`` with noise, so that the truth is known. The file
identification.json says what a fit varies. If noise is small, estimates scatter by
sigma (J^T J)^-1/2 with J the derivatives of the measured numbers.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from common import HERE, HINGES, arguments, panels, save

import sandbox

SCENE, STUDY = "finger_swing", HERE / "identification.json"
ANGLES, TIP = [f"finger.{hinge}.angle" for hinge in HINGES], ["tip_x", "tip_y"]
NAMES = ("k1", "k2", "k3", "c1", "c2", "c3")
NOISE, TIP_NOISE = np.radians(0.5), 0.5e-3  # standard deviations [rad], [m]
TIMES = np.arange(1, 32) * 0.01
PAGE = {"independent": (4.3, 1.5, 0.6, 15, 12, 12), "pull unknown": (7.8, 8.1, 8.4, 12, 14, 16),
        "ten times slower": (5.0, 1.3, 0.7, 174, 87, 103),
        "tip only": (11, 37, 2.8, 15, 71, 30)}
SLOW = {"parameters.over": "0.3 s", "parameters.until": "1.5 s", "run.duration": "3.2 s",
        "run.step": "2 ms", "run.sample_rate": 500}
VARY = {"parameters.k1": "3000 N/m:9000 N/m", "parameters.k2": "1500 N/m:4500 N/m",
        "parameters.k3": "600 N/m:1800 N/m", "parameters.c1": "1 N mm s/rad:8 N mm s/rad",
        "parameters.c2": "0.5 N mm s/rad:3 N mm s/rad",
        "parameters.c3": "0.1 N mm s/rad:0.8 N mm s/rad"}


def motion(names: Sequence[str], times: np.ndarray, given: Mapping[str, Any]) -> np.ndarray:
    """Quantities of a run at some times, shape [quantities, times]."""
    run = sandbox.simulate(sandbox.load_scene(SCENE, overrides=dict(given)))
    return np.array([np.interp(times, run.time, run[name]) for name in names])


def measure(path: Path, values: np.ndarray, names: Sequence[str], times: np.ndarray, size: float,
            seed: int, correlation: float = 0.0) -> Path:
    """Write a measurement with noise, of which neighbours correlate."""
    noise = np.random.default_rng(seed).normal(size=values.shape)
    for i in range(1, values.shape[1]):
        noise[:, i] = correlation * noise[:, i - 1] + np.sqrt(1 - correlation**2) * noise[:, i]
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["time", *names])
        rows.writerows(np.column_stack([times, (values + size * noise).T]).tolist())
    return path


def widths(truth: np.ndarray) -> np.ndarray:
    """Halves of the 95 % intervals in closed form, as shares of the truth, shape [6]."""
    slopes = []
    for name, value in zip(NAMES, truth, strict=True):
        up, down = (motion(ANGLES, TIMES, {f"parameters.{name}": (1 + sign * 0.01) * value})
                    for sign in (1, -1))
        slopes.append((up - down).ravel() / 0.02)
    jacobian = np.array(slopes).T
    return np.asarray(1.96 * NOISE * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))))


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    data = options.out / "measured.csv"
    given = sandbox.load_scene(SCENE).parameters
    truth = np.array([given[name] for name in NAMES])
    values = motion(ANGLES, TIMES, {})
    theory, found = widths(truth), {}
    figure, axes = panels(2, 3, 7.5, 2.2)
    for kind, correlation in (("independent", 0.0), ("correlated", 0.7)):
        held, remarks = [], 0
        count = 1 if options.quick else 12
        for seed in range(count if kind == "independent" or not options.quick else 0):
            fit = sandbox.search.fit(STUDY, measure(data, values, ANGLES, TIMES, NOISE, seed,
                                                    correlation))
            remarks += any("are not random" in line for line in fit.lines)
            for name, cell, one, true in zip(NAMES, axes.flat, fit.parameters, truth, strict=True):
                held.append(one.low <= true <= one.high)
                if kind == "independent":
                    half = found[f"{name} half"] = (one.high - one.low) / 2 / true
                    cell.errorbar(seed, one.value / true, half, fmt="ok")
                    cell.set_title(name, fontsize=8)
        if held:
            found[f"{kind} held"] = float(np.mean(held))
            print(f"{kind} noise: {np.mean(held):.0%} of {len(held)} intervals hold the truth; "
                  f"{remarks} of {count} fits say that neighbours correlate")
    for i, (name, cell) in enumerate(zip(NAMES, axes.flat, strict=True)):
        cell.axhline(1, color="tab:green")
        found[f"{name} theory"] = float(theory[i])
        print(f"{name}: half of the 95 % interval {found[f'{name} half']:.1%}, sigma (J^T J)^-1/2 "
              f"says {theory[i]:.1%} (page: {PAGE['independent'][i]} %)")
    figure.supxlabel("measurement; estimate over truth with its 95 % interval", fontsize=9)
    save(figure, options.out / "study_identification_intervals.png")
    figure, axes = panels(1, 1, 6.5, 3.2)
    seen = np.genfromtxt(measure(data, values, ANGLES, TIMES, NOISE, 0), delimiter=",", names=True)
    estimate = {one.path: one.value for one in sandbox.search.fit(STUDY, data).parameters}
    fine = np.linspace(0, TIMES[-1], 200)
    fitted = motion(ANGLES, fine, estimate)
    for i, name in enumerate(ANGLES):
        axes[0, 0].plot(fine, np.degrees(fitted[i]), f"C{i}", label=name)
        axes[0, 0].plot(TIMES, np.degrees(seen[seen.dtype.names[i + 1]]), f"oC{i}", markersize=3)
    axes[0, 0].set(xlabel="time [s]", ylabel="angle [deg]")
    save(figure, options.out / "study_identification_motion.png")
    for name, columns, times, size, vary, changes in () if options.quick else (
            ("ten times slower", ANGLES, 10 * TIMES, NOISE, VARY, SLOW),
            ("tip only", TIP, TIMES, TIP_NOISE, VARY, {}),
            ("pull unknown", ANGLES, TIMES, NOISE, VARY | {"parameters.pull": "3 N:8 N"}, {})):
        measure(data, motion(columns, times, changes), columns, times, size, 0)
        fit = sandbox.search.fit(SCENE, data, vary=vary, set=changes)
        halves = [50 * (one.high - one.low) / true
                  for one, true in zip(fit.parameters, truth, strict=False)]
        print(f"{name}: halves {', '.join(f'{x:.3g}' for x in halves)} % (page: {PAGE[name]})")
    data.unlink()
    return found


if __name__ == "__main__":
    main()
