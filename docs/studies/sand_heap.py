"""How steep is a heap of discs? Its slope against the friction of the discs, five heaps each.

Two walls hold 120 discs on a rough floor and are lifted. A triangle of slope s has means of height
and of distance from its middle in the ratio s, which measures the slope without a fit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import HERE, arguments, panels, save, stills

import sandbox

FRICTIONS, SEEDS = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8), range(1, 6)
BASE = 2e-3  # height of the floor, half that of its bumps [m]
MOVED = 0.1  # s at the end in which a heap at rest must not move


def heap(friction: float, seed: int) -> sandbox.Recording:
    """One heap of discs."""
    return sandbox.simulate(sandbox.load_scene(HERE / "sand_heap.json", overrides={
        "parameters.mu": friction, "parameters.seed": seed}))


def slope(run: sandbox.Recording) -> float:
    """Slope of a heap [rad], from the places of its discs at the end, by their masses."""
    discs = [body for body in run.mechanism.bodies if body.role == "object"]
    x, y = (np.array([run[f"{disc.name}.{axis}"][-1] for disc in discs]) for axis in "xy")
    mass = np.array([disc.mass for disc in discs])
    y = y - BASE
    away = np.abs(x - np.average(x, weights=mass))
    return float(np.arctan(np.average(y, weights=mass) / np.average(away, weights=mass)))


def carried(run: sandbox.Recording) -> float:
    """Vertical force of the ground over the weight of the discs at the end."""
    ground = [body.name for body in run.mechanism.bodies if body.motion == "fixed"]
    weight = 9.81 * sum(body.mass for body in run.mechanism.bodies if body.role == "object")
    return -sum(float(run[f"{name}.contact.fy"][-1]) for name in ground) / weight


def creep(run: sandbox.Recording) -> float:
    """Largest way of a disc in the last tenth of a second [m]."""
    names = [body.name for body in run.mechanism.bodies if body.role == "object"]
    late = run.time > run.time[-1] - MOVED
    return max(float(np.ptp(run[f"{name}.{axis}"][late])) for name in names for axis in "xy")


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    frictions, seeds = ((0.0, 0.5), [1]) if options.quick else (FRICTIONS, SEEDS)
    found: dict[str, float] = {"carried": 0.0, "creep": 0.0}
    angles, shown = [], []
    for friction in frictions:
        runs = [heap(friction, seed) for seed in seeds]
        each = np.degrees([slope(run) for run in runs])
        found[f"slope {friction:g}"] = float(each.mean())
        found["carried"] = max(found["carried"], *(abs(carried(run) - 1) for run in runs))
        found["creep"] = max(found["creep"], *map(creep, runs))
        print(f"friction {friction:g}: slope {each.mean():.1f} deg, {each.min():.1f} to "
              f"{each.max():.1f}")
        angles.append(each)
        if friction in (0.0, 0.1, 0.5):
            shown.append((runs[0], f"friction {friction:g}"))
    print(f"the ground carries the weight within {found['carried']:.1g}; in the last {MOVED:g} s "
          f"discs move {found['creep']:.1g} m at most")
    figure, axes = panels(1, 1, 6.0, 3.4)
    axes[0, 0].plot(np.repeat(frictions, len(seeds)), np.ravel(angles), ".", color="0.6",
                    label="one heap")
    axes[0, 0].plot(frictions, np.mean(angles, axis=1), "o-", label="mean")
    axes[0, 0].plot(frictions, np.degrees(np.arctan(frictions)), "k:",
                    label="block on a plane, atan \N{GREEK SMALL LETTER MU}")
    axes[0, 0].set(xlabel="friction", ylabel="slope [deg]", ylim=(0, 40))
    save(figure, options.out / "study_sand_heap.png")
    stills(options.out / "study_sand_heap_shapes.png", *zip(*shown, strict=True), 1, (720, 240))
    return found


if __name__ == "__main__":
    main()
