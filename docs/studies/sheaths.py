"""Friction in the sheaths: how much of the pull reaches the tip, and what it does to adaptation.

Over a bend phi a tendon that slides keeps e^(-mu phi) of its tension (Euler, Eytelwein); one that
is drawn back has e^(mu phi) of it, and between the two nothing moves. At hinge i acts the piece
between guides i - 1 and i: tau_i = T_i h_i - k s_i, f = J^-T tau.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from common import HERE, PHALANGES, ClosedForm, arguments, panels, save

import sandbox
from sandbox.mechanics.chain import to_world, transforms
from sandbox.mechanics.closure import force_spread
from sandbox.mechanics.grasp import disc_centre, disc_grasp
from sandbox.mechanics.statics import contact_forces, contact_jacobian
from sandbox.mechanics.tendon import guide_wraps

PULL, BEND = 8.0, np.pi  # on a finger [N]; of a sheath [rad]


def closed_form(radius: float, bend: float, sheath: float, guides: float) -> np.ndarray:
    """Bend in all, tension in the tip / pull, and forces round the disc of ``sheathed_finger``."""
    scene = sandbox.load_scene("sheathed_finger", overrides={"parameters.radius": radius})
    part = next(part for part in scene.parts if part.type == "finger")
    form, given = ClosedForm(part), scene.parameters
    centre = disc_centre(given["knuckle"], given["foot"], radius, part.radii[0])
    grasp = disc_grasp(centre, radius, part.lengths, part.radii)
    far = to_world(transforms(grasp.theta, form.lengths), np.array(part.guides[1:]))
    wraps = guide_wraps(np.vstack([part.tendon_to[0].at, part.guides[0], far]))
    tension = PULL * np.exp(-sheath * bend - guides * np.cumsum(wraps))
    torques = tension * form.tendon.arms(grasp.theta) + form.torques(grasp.theta, 0.0)
    forces = contact_forces(contact_jacobian(grasp.theta, form.lengths, grasp.distances), torques)
    return np.array([bend + (guides > 0) * wraps.sum(), tension[-1] / PULL, *forces])


def fingers(quick: bool) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Varied values, results and closed forms of one finger; [runs, 5] each."""
    study = json.loads((HERE / "sheaths.json").read_text(encoding="utf-8"))
    few = {"parameters.guides": [0, 1], "parameters.radius": ["16 mm"],
           "parameters.phi": ["90 deg", "180 deg"], "parameters.mu": [0.05, 0.2]}
    table = sandbox.sweep(study["scene"], set=study["set"], keep=study["keep"], audit=False,
                          vary=few if quick else study["vary"])
    rows = {path.split(".")[1]: np.array(table[path]) for path in few}
    closed = [closed_form(r, bend, mu, guides * mu) for guides, r, bend, mu in zip(
        *rows.values(), strict=True)]
    found = [table[name] for name in ("touching", "share", *PHALANGES)]
    return rows, np.column_stack(found), np.array(closed)


def hands(quick: bool, path: Path) -> dict[str, float]:
    """Tensions of the fingers of two hands: closed, and after the third object has grown."""
    mu = [0.1] if quick else [1e-9, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]  # 1e-9: no friction
    keep = [f"{name}{i}=mean finger{i}.tendon.tension_0 over {window}" for i in range(1, 5)
            for name, window in (("closed", "1.1 s:1.2 s"), ("grown", "1.9 s:2 s"))]
    hand = sandbox.sweep("sheathed_hand", audit=False, keep=keep, vary={
        "parameters.uneven": [0, 1], "parameters.phi": ["180 deg"], "parameters.mu": mu})
    one = sandbox.sweep(
        "sliding_pulleys", set={"parameters.pull": "8 N", "run.duration": "2 s"}, audit=False,
        vary={"parameters.mu": [0, 0.02, 0.1] if quick else [0, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2]},
        keep=[f"closed{i}=mean finger{i}.tendon.tension over last 0.1 s" for i in range(1, 6)])
    friction = np.linspace(0, 0.3, 61)[:, None]
    turns = np.exp(-2 * BEND * friction * np.arange(5)) * (1 + np.exp(-BEND * friction))
    even = hand["parameters.uneven"] == 0
    cases = {"one tendon over pulleys": (one, slice(None), "closed", 5, turns),
             "third object grown": (hand, even, "grown", 4, np.exp(
                 BEND * friction * np.array([-1, -1, 1, -1]))),
             "sheaths of 0 to 180 deg": (hand, ~even, "closed", 4, np.exp(
                 -BEND * friction * np.arange(4) / 3))}
    figure, axes = panels(1, 1, 6.0, 3.4)
    for colour, (name, (table, which, when, count, closed)) in enumerate(cases.items()):
        tension = np.stack([table[f"{when}{i}"][which] for i in range(1, count + 1)], axis=1)
        axes[0, 0].plot(friction[:, 0], force_spread(closed), f"C{colour}", label=name)
        axes[0, 0].plot(table["parameters.mu"][which], force_spread(tension), f"oC{colour}")
    axes[0, 0].set(xlabel="friction", ylabel="standard deviation / mean of tensions")
    save(figure, path)
    grown = hand["grown3"][even] / (PULL * np.exp(hand["parameters.mu"][even] * BEND))
    off = float(np.abs(grown - 1).max())
    print(f"a finger that is pushed back has e^(mu phi) of its pull within {off:.2%}")
    return {"pushed back": off}


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    rows, runs, closed = fingers(options.quick)
    held = runs[:, 1] > 1.001 * closed[:, 1]  # the tendon sticks somewhere in the finger
    wraps, rubbing = runs[:, 0] == 3, rows["guides"] == 1
    off = float(np.abs(runs[:, 1] / closed[:, 1] - 1)[wraps & ~rubbing].max())
    force = float(np.abs(runs[:, 2:] - closed[:, 2:])[wraps & ~held].max())
    print(f"a sheath leaves e^(-mu phi) of the pull within {off:.1%}; where the tendon slides, "
          f"forces are within {force:.1g} N of J^-T tau in {(wraps & ~held).sum()} grasps")
    print(f"fingers that wrap their disc: {(wraps & ~rubbing).sum()}, if guides rub "
          f"{(wraps & rubbing).sum()} (page: 93 and 77 of 105)")
    figure, axes = panels(2, 1, 6.5, 2.8)
    bends = np.linspace(0, 8.4, 85)
    for i, mu in enumerate((0.05, 0.1, 0.2, 0.3)):
        some = (rows["mu"] == mu) & ~held
        axes[0, 0].plot(np.degrees(bends), np.exp(-mu * bends), f"C{i}", label=f"friction {mu:g}")
        axes[0, 0].plot(np.degrees(closed[some, 0]), runs[some, 1], f"oC{i}")
    some = rubbing & np.isclose(rows["phi"], BEND) & np.isclose(rows["radius"], 0.016)
    for i, name in enumerate(PHALANGES):
        axes[1, 0].plot(rows["mu"][some], closed[some, i + 2], f"C{i}", label=name)
        axes[1, 0].plot(rows["mu"][some], runs[some, i + 2], f"oC{i}")
    axes[0, 0].set(xlabel="bend of sheath and guides [deg]", ylabel="tension in the tip / pull")
    axes[1, 0].set(xlabel="friction (sheath of 180 deg)", ylabel="contact force [N]")
    save(figure, options.out / "study_sheath_share.png")
    found = {"share": off, "force": force}
    found |= hands(options.quick, options.out / "study_sheath_spread.png")
    figure, axes = panels(1, 1, 6.0, 3.4)
    for friction in (0.1,) if options.quick else (0.05, 0.1, 0.2):
        run = sandbox.simulate(sandbox.load_scene("sheathed_hand", overrides={
            "parameters.mu": friction, "parameters.phi": BEND, "parameters.grow": 0,
            "parameters.rest": 0.02}))
        pull, tension = run["actuator.value"] / 4, run["finger2.tendon.tension_0"]
        low, closed = np.exp(-friction * BEND), np.zeros(len(pull))
        for i, each in enumerate(pull[1:], start=1):
            closed[i] = np.clip(closed[i - 1], each * low, each / low)
        area, exact = -np.trapezoid(tension, pull), -np.trapezoid(closed, pull)
        print(f"area of the loop at friction {friction:g}: {area:.2f} N^2, closed {exact:.2f}")
        found[f"loop {friction:g}"] = float(area / exact - 1)
        axes[0, 0].plot(pull, tension, label=f"friction {friction:g}")
        axes[0, 0].plot(pull[::60], closed[::60], "k.")
    axes[0, 0].set(xlabel="pull on a finger [N]; dots: closed form", ylabel="tension in it [N]")
    save(figure, options.out / "study_sheath_loop.png")
    return found


if __name__ == "__main__":
    main()
