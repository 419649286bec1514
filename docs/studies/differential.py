"""A differential against none: four fingers on rockers, on springs from one bar, and tied rigidly.

A finger that has taken up X_j of its tendon on a bar that has gone x is pulled with k (x - X_j), k
that of its spring in series with the cord, so that T_j = F / n + k (mean of X - X_j). On rockers
T = F / n.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import ClosedForm, arguments, panels, save, stills
from gripping_force import PRESSES, hand_sweep

import sandbox
from sandbox.mechanics.closure import force_spread

PULL, CORD = 25.0, 1e5  # of the actuator [N]; stiffness of a cord [N/m]
RANGES = {"r": ("10 mm", "24 mm"), "x": ("0 mm", "30 mm"), "gap": ("4 mm", "20 mm")}
SPRINGS = {"rockers": np.inf, "springs of 100 N/m": 100.0, "springs of 300 N/m": 300.0,
           "rigid": 1e5}  # stiffness of the connection [N/m]
PAGE = {"rockers": (0, 24, 0.2), "springs of 100 N/m": (5, 18, 0.2),
        "springs of 300 N/m": (16, 12, 0), "rigid": (153, 161, 64)}  # medians, sections lost [%]
SHOWN = 5  # number of the object in the picture of two hands
ORDER = ("stopped first", "second", "third", "last")


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    count = 8 if options.quick else 128
    rockers = hand_sweep("four_discs", RANGES, count, 15, {})
    bar = hand_sweep("four_on_a_bar", RANGES, count, 15,
                     {"parameters.k": ["100 N/m", "300 N/m", "100 kN/m"]})
    cases = {name: rockers if np.isinf(k) else
             {key: value[bar["parameters.k"] == k] for key, value in bar.items()}
             for name, k in SPRINGS.items()}
    still = np.all([rows["still"].reshape(-1, 4).all(axis=1) for rows in cases.values()], axis=0)
    form = ClosedForm(sandbox.load_scene("four_discs").parts[0])
    travel = form.tendon.shortening(rockers["theta"]).reshape(-1, 4)[still]
    order = np.argsort(travel, axis=1, kind="stable")
    figure, axes = panels(len(cases), 4, 7.0, 1.4)
    spreads, plane = panels(1, 1, 6.0, 3.2)
    found = {}
    for row, (name, rows) in zip(axes, cases.items(), strict=True):
        tension = rows["tension"].reshape(-1, 4)[still]
        force = rows["forces"].sum(axis=1).reshape(-1, 4)[still]
        lost = ((rows["forces"] > PRESSES).sum(axis=1).reshape(-1, 4)[still] < 2).mean()
        uneven, grip = force_spread(tension), force_spread(force)
        # closed form: the cords' stretch of T / k is part of what a finger takes up
        series = 0.0 if np.isinf(SPRINGS[name]) else 1 / (1 / SPRINGS[name] + 1 / CORD)
        taken = form.tendon.shortening(rows["theta"]).reshape(-1, 4)[still]
        closed = PULL / 4 + series * (taken.mean(axis=1, keepdims=True) - taken)
        off = float(np.percentile(np.abs(closed - tension), 95))
        found |= {f"{name} tensions": float(np.median(uneven)), f"{name} lost": float(lost),
                  f"{name} forces": float(np.median(grip)), f"{name} off": off}
        page = "/".join(f"{value:g}" for value in PAGE[name])
        print(f"{name}: spread of tensions {np.median(uneven):.1%}, of contact forces "
              f"{np.median(grip):.0%}; sections lost {lost:.1%} (page: {page} %); largest and "
              f"least tension {np.median(tension.max(axis=1)):.2f}, "
              f"{np.median(tension.min(axis=1)):.2f} N; closed form within {off:.1g} N for 95 %")
        for cell, title, each in zip(row, ORDER, np.take_along_axis(tension, order, 1).T,
                                     strict=True):
            cell.hist(each, bins=25, range=(0, PULL), color="tab:blue")
            cell.axvline(PULL / 4, color="tab:green")
            cell.set_title(f"{name}: {title}", fontsize=7)
        plane[0, 0].plot(1e3 * travel.std(axis=1), 100 * uneven, ".", label=name)
        if 0 < series < 1e3:
            x = np.array([0.0, travel.std(axis=1).max()])
            plane[0, 0].plot(1e3 * x, 100 * series * x / (PULL / 4), "k-", linewidth=0.8)
    figure.supxlabel("tension [N]; line: F / 4", fontsize=9)
    save(figure, options.out / "study_differential_tensions.png")
    plane[0, 0].set(xlabel="spread of the travels on rockers [mm]; lines: k times it",
                    ylabel="spread of tensions [%]")
    save(spreads, options.out / "study_differential_spread.png")
    given = {f"parameters.{name}{i + 1}": float(rockers[name].reshape(-1, 4)[SHOWN, i])
             for name in RANGES for i in range(4)}
    stills(options.out / "study_differential_hands.png", [
        sandbox.simulate(sandbox.load_scene("four_discs", overrides=given)),
        sandbox.simulate(sandbox.load_scene("four_on_a_bar", overrides=given | {
            "parameters.k": SPRINGS["rigid"]}))],
        ["A tree of rockers", "Tied rigidly to one bar"], 2, (480, 560))
    return found


if __name__ == "__main__":
    main()
