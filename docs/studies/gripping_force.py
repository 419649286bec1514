"""Does the gripping force depend on the object? 512 random runs of four discs, 256 with squares.

The paper reads off its Figure 7 that the largest force of a phalanx is between 1 and 2 N wherever
the object lies. Pose and tension decide the forces, f = J^-T (T h - k s), as far as they push.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from common import HINGES, PHALANGES, ClosedForm, arguments, panels, save, stills

import sandbox
from sandbox.mechanics.chain import hinges, transforms
from sandbox.mechanics.statics import point_jacobian, unilateral_forces

FINGERS, CLAIM = range(1, 5), (1.0, 2.0)
PRESSES, STILL = 0.01, 0.01  # least force of a contact [N], largest rate at rest [rad/s]
DISCS = {"r": ("6 mm", "26 mm"), "x": ("-5 mm", "60 mm"), "gap": ("2 mm", "35 mm")}
SQUARES = {"r": ("8 mm", "20 mm"), "x": ("0 mm", "40 mm"), "gap": ("4 mm", "25 mm"),
           "side": ("6 mm", "16 mm"), "turn": ("-60 deg", "0 deg")}
PAGE = (21, 75, 61, 69)  # [%]
HAND = {"r1": 0.020, "x1": 0.015, "gap1": 0.012, "r2": 0.022, "x2": 0.050, "gap2": 0.020,
        "r3": 0.008, "x3": 0.003, "gap3": 0.006, "r4": 0.009, "x4": 0.022, "gap4": 0.015}


def hand_sweep(scene: str, ranges: Mapping[str, tuple[str, str]], count: int, seed: int,
               other: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Four random sections a run; results with one row a finger, [4 runs] or [4 runs, 3]."""
    names = {"tension": ["tendon.tension"], "forces": [f"{p}.contact.normal" for p in PHALANGES]}
    last = " over last 0.1 s"
    keep = {f"{name}{j}_{i}": f"mean finger{i}.{quantity}{last}" for i in FINGERS
            for name, all_of in names.items() for j, quantity in enumerate(all_of)}
    keep |= {f"theta{j}_{i}": f"finger{i}.{h}.angle" for i in FINGERS for j, h in enumerate(HINGES)}
    keep |= {f"rate0_{i}": f"max moves{i}{last}" for i in FINGERS}
    sections = {f"parameters.{name}{i}": {"from": low, "to": high} for i in FINGERS
                for name, (low, high) in ranges.items()}
    table = sandbox.sweep(scene, vary=[{"design": "sobol", "count": count, "over": sections},
                                       *([{"over": dict(other)}] if other else [])],
                          keep=[f"{name}={text}" for name, text in keep.items()], seed=seed)

    def column(name: str) -> np.ndarray:
        return np.array([table[name.format(i)] for i in FINGERS]).T.reshape(-1)

    rows = {name: column(f"parameters.{name}{{}}") for name in ranges}
    rows |= {name: np.repeat(table[name], len(FINGERS)) for name in other}
    rows |= {name: np.stack([column(f"{name}{j}_{{}}") for j in range(3)], axis=1)
             for name in ("forces", "theta")}
    rows["tension"] = column("tension0_{}")
    rows["still"] = np.repeat(table.done, len(FINGERS)) & (column("rate0_{}") < STILL)
    return rows


def statics(form: ClosedForm, rows: Mapping[str, np.ndarray], finger: int) -> np.ndarray:
    """Forces that hold a finger in its recorded pose round its disc [N], shape [3]."""
    theta, radius = rows["theta"][finger], rows["r"][finger]
    frames = transforms(theta, form.lengths)
    centre = np.array([rows["x"][finger], -form.radii[0] - rows["gap"][finger] - radius])
    to = centre - hinges(frames)
    k = np.clip((to * frames[:, :2, 0]).sum(axis=1), 0, form.lengths)
    axis = hinges(frames) + k[:, None] * frames[:, :2, 0]
    apart = np.linalg.norm(axis - centre, axis=1)
    touch = apart - radius - form.radii < 1e-6
    jacobian = point_jacobian(axis, (axis - centre) / apart[:, None], hinges(frames), np.arange(3))
    found = np.zeros(3)
    found[touch] = unilateral_forces(
        jacobian[touch], form.torques(theta, rows["tension"][finger]),
        lower=theta < form.limits[:, 0] + 1e-6, upper=theta > form.limits[:, 1] - 1e-6).forces
    return found


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    few = 4 if options.quick else 1
    pulls, rubs = {"parameters.pull": ["15 N", "25 N"]}, {"parameters.friction": [0, 0.5]}
    discs = hand_sweep("four_discs", DISCS, 256 // few**2, 14, pulls)
    squares = hand_sweep("four_sections", SQUARES, 128 // few**2, 14, rubs)
    groups = {f"discs, {pull} N": (discs, discs["parameters.pull"] == pull) for pull in (15, 25)}
    groups |= {f"squares, friction {mu:g}": (squares, squares["parameters.friction"] == mu)
               for mu in (0, 0.5)}
    figure, axes = panels(len(groups), 3, 7.0, 1.5)
    found = {}
    for row, page, (name, (rows, which)) in zip(axes, PAGE, groups.items(), strict=True):
        forces = rows["forces"][which & rows["still"]]
        largest, pressing = forces.max(axis=1), forces > PRESSES
        claimed = (largest >= CLAIM[0]) & (largest <= CLAIM[1])
        found[name] = float(claimed.mean())
        low, middle, high = np.percentile(largest, [5, 50, 95])
        counts = np.bincount(pressing.sum(axis=1), minlength=4)[1:] / len(forces)
        print(f"{name}: largest force 1 to 2 N on {claimed.mean():.0%} of {len(forces)} (page: "
              f"{page} %); 5, 50, 95 %: {low:.1f}, {middle:.1f}, {high:.1f} N; 1, 2, 3 "
              f"phalanges press: {', '.join(f'{share:.0%}' for share in counts)}")
        for cell, phalanx, on, each in zip(row, PHALANGES, pressing.T, forces.T, strict=True):
            cell.hist(np.clip(each[on], 0, 5), bins=25, range=(0, 5), color="tab:blue")
            cell.axvspan(*CLAIM, color="tab:green", alpha=0.2)
            cell.set_title(f"{phalanx}, {name}", fontsize=7)
    figure.supxlabel("force of the phalanx [N]; shaded: 1 to 2 N", fontsize=9)
    save(figure, options.out / "study_gripping_forces.png")
    form = ClosedForm(sandbox.load_scene("four_discs").parts[0])
    still = np.flatnonzero(discs["still"])
    off = np.array([np.abs(statics(form, discs, finger) - discs["forces"][finger]).max()
                    for finger in still])
    found["statics, 99 %"] = float(np.percentile(off, 99))
    print(f"forces by statics of the pose: half of {len(off)} within {np.median(off):.1g} N, 99 % "
          f"within {found['statics, 99 %']:.1g} N")
    at = still[discs["parameters.pull"][still] == 25]
    figure, axes = panels(1, 3, 7.0, 2.8)
    for cell, (low, high) in zip(axes.flat, ((6, 10), (10, 16), (16, 26)), strict=True):
        size = at[(discs["r"][at] >= low / 1e3) & (discs["r"][at] < high / 1e3 + 1e-9)]
        largest = discs["forces"][size].max(axis=1)
        for some, label, colour in ((largest < 1, "< 1 N", "tab:blue"), (
                (largest >= 1) & (largest <= 2), "1 to 2 N", "tab:green"),
                (largest > 2, "> 2 N", "tab:orange")):
            cell.plot(1e3 * discs["x"][size[some]], 1e3 * discs["gap"][size[some]], ".",
                      color=colour, label=label)
        cell.set(title=f"radius {low} to {high} mm", xlabel="from the hinge [mm]")
    axes[0, 0].set_ylabel("gap below the finger [mm]")
    save(figure, options.out / "study_gripping_places.png")
    run = sandbox.simulate(sandbox.load_scene("four_discs", overrides={
        f"parameters.{name}": value for name, value in HAND.items()}))
    stills(options.out / "study_gripping_hand.png", [run], [""], 1, (640, 640))
    return found


if __name__ == "__main__":
    main()
