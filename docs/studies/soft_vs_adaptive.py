"""Figure 2d: springs from one bar against a differential, on the same fingers and objects.

A finger that wraps its section without friction takes up a length x_j of tendon that depends on the
section only. A differential pulls each of n fingers with T = F / n, springs k on one bar with
T_j = F / n + k (mean of x - x_j), k in series with the finger's cord. What a finger presses with is
the sum of f = J^-T tau at its tension.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import ClosedForm, arguments, panels, save, stills

import sandbox
from sandbox.mechanics.closure import force_spread
from sandbox.mechanics.grasp import disc_grasp

PULL, HANDS = 20.0, (np.inf, 300.0, 600.0)  # F [N]; springs [N/m], inf for the differential
OBJECTS = {"bottle": {"parameters.object": 1}, "cone": {"parameters.object": 2},
           "bottle, finger3 stopped early": {"parameters.object": 1, "parameters.blocked": 3}}
SHOWN = "bottle, finger3 stopped early"
PAGE = {  # spread of the contact forces [%], by hand
    "bottle": (17, 5, 9), "cone": (15, 4, 8), "bottle, finger3 stopped early": (21, 6, 28)}


def named(stiffness: float) -> str:
    """What a hand is called."""
    return f"springs of {stiffness:g} N/m" if np.isfinite(stiffness) else "differential"


def hand(given: dict[str, float], stiffness: float) -> tuple[sandbox.Recording, np.ndarray]:
    """A run, and of its fingers T, x, contact force, and T and force in closed form; [5, 5]."""
    soft = bool(np.isfinite(stiffness))
    changed = given | ({"parameters.pull": PULL, "parameters.k": stiffness} if soft else
                       {"parameters.pull": PULL / 10})
    scene = sandbox.load_scene("elastic_tendons" if soft else "sliding_pulleys", overrides=changed)
    run, parts = sandbox.simulate(scene), {part.name: part for part in scene.parts}
    fingers, poses = [], []
    for number in range(1, 6):
        part, section = parts[f"finger{number}"], parts[f"section{number}"]
        fingers.append(ClosedForm(part))
        poses.append(disc_grasp(np.subtract(section.at, part.at), section.circle, part.lengths,
                                part.radii))
    x = np.array([float(form.tendon.shortening(pose.theta))
                  for form, pose in zip(fingers, poses, strict=True)])
    series = 1 / (1 / stiffness + 1 / parts["finger1"].tendon.stiffness) if soft else 0.0
    tension = PULL / 5 + series * (x.mean() - x)
    force = [float(form.forces(pose.theta, pose.distances, each).sum())
             for form, pose, each in zip(fingers, poses, tension, strict=True)]
    found = [[run[f"finger{i}.tendon.tension"][-1], run[f"x{i}"][-1],
              run[f"finger{i}.contact.normal"][-1]] for i in range(1, 6)]
    return run, np.column_stack([np.array(found), tension, force])


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    figure, axes = panels(len(OBJECTS), 1, 6.5, 2.2)
    numbers: dict[str, float] = {}
    shown, off = [], 0.0
    for cell, (name, given) in zip(axes.flat, OBJECTS.items(), strict=True):
        for stiffness, page in zip(HANDS, PAGE[name], strict=True):
            run, found = hand(given, stiffness)
            tensions, forces = (float(x) for x in force_spread(found[:, [0, 2]].T))
            off = max(off, float(np.abs(found[:, [0, 2]] - found[:, [3, 4]]).max()))
            numbers[f"{name}, {named(stiffness)}"] = forces
            print(f"{name}, {named(stiffness)}: tensions spread by {tensions:.0%}, contact forces "
                  f"by {forces:.0%} (page: {page} %)")
            for i, (t, x, f) in enumerate(found[:, :3], start=1):
                print(f"  finger{i}: x {1e3 * x:.2f} mm, T {t:.2f} N, sum of forces {f:.2f} N")
            cell.plot(range(1, 6), found[:, 0], "o-", label=named(stiffness))
            cell.plot(range(1, 6), found[:, 3], "kx")
            if name == SHOWN and stiffness != HANDS[1]:
                shown.append(run)
        cell.set(title=name, ylabel="tension [N]", ylim=(0, 9), xticks=range(1, 6))
    axes[-1, 0].set_xlabel("finger (crosses: closed form)")
    save(figure, options.out / "soft_tensions.png")
    stills(options.out / "soft_hands.png", shown[::-1],
           ["One bar and springs of 600 N/m", "One cord over sliding pulleys"], 1, (720, 560))
    print(f"largest difference from the closed form: {off:.1g} N (page: 1e-9)")
    return numbers | {"off": off}


if __name__ == "__main__":
    main()
