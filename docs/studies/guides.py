"""Where to put the guides: phalanges that press alike over a range of discs, and what it costs.

The search guides.json looks at three pulls, a second one at one pull only. The pose of a finger
round a disc is geometry, so f = J^-T (T h - k s).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np
from common import HERE, PHALANGES, ClosedForm, arguments, panels, save, stills

import sandbox
from sandbox.mechanics.grasp import disc_centre, disc_grasp

PULLS, PULL, MM = (2.5, 3.75, 7.5, 15.0), 3.75, 1e-3
NAMES = [f"parameters.{part}_{axis}" for part in ("palm", *PHALANGES) for axis in "xy"] + [
    f"parameters.{part}_k" for part in PHALANGES]
DESIGNS = {  # guides V_0 to V_3, x and y [mm]; springs [N/m]; those found are rounded
    "one height": (-15, -5, 22.5, -5, 13, -5, 10.5, -5, 300, 300, 300),
    "Set G": (-22, -14, 24, -8, 10, -3, 4, -1, 300, 300, 300),
    "best at one pull": (-22, -14, 30.7, -4.5, 13.9, -2.2, 3.9, -3, 344, 398, 465),
    "best at three pulls": (-22, -14, 31.8, -7.3, 14.1, -1.5, 3.9, -0.55, 287, 364, 105)}
PAGE = {  # spread on discs of 12 to 20 mm at PULLS, on thin and thick discs, elsewhere, on squares
    "one height": (1.27, 1.27, 1.27, 1.41, 0.71, 1.41, 1.30, 1.41),
    "Set G": (0.78, 0.23, 0.22, 0.38, 0.22, 0.57, 0.36, 0.83),
    "best at one pull": (0.92, 0.05, 0.58, 0.68, 0.15, 0.22, 0.44, 0.82),
    "best at three pulls": (0.05, 0.04, 0.07, 0.09, 0.16, 0.08, 0.30, 0.82)}
PLACES = {"parameters.touch": ["22 mm", "26 mm", "30 mm", "34 mm", "38 mm"],
          "parameters.lean": ["25 deg", "40 deg", "55 deg"],
          "parameters.radius": ["12 mm", "16 mm", "20 mm"]}
SQUARE = {"bodies[disc].angle": "=-lean", "bodies[disc].shapes": [
    {"type": "box", "size": ["=2 * radius", "=2 * radius"]}]}


def values(name: str) -> dict[str, float]:
    """A design as values of the parameters of ``guided_finger``, SI."""
    numbers = np.array(DESIGNS[name], dtype=float) * ([MM] * 8 + [1.0] * 3)
    return dict(zip(NAMES, numbers.tolist(), strict=True))


def spread(forces: np.ndarray) -> np.ndarray:
    """Standard deviation over mean of forces [..., 3], 2 where nothing presses."""
    pressing = np.clip(forces, 0, None)
    mean = pressing.mean(axis=-1)
    return np.where(mean > 1e-3, pressing.std(axis=-1) / np.maximum(mean, 1e-3), 2.0)


def closed(given: Mapping[str, float], radius: float, pull: float) -> np.ndarray:
    """Forces of the phalanges round a disc [N], shape [3]; below 0 one would have to pull."""
    form = ClosedForm(sandbox.load_scene("guided_finger", overrides=dict(given)).parts[0])
    centre = disc_centre(np.radians(35), 31 * MM, radius, form.radii[0])
    grasp = disc_grasp(centre, radius, form.lengths, form.radii)
    return np.asarray(form.forces(grasp.theta, grasp.distances, np.array(pull)))


def forces(others: Mapping[str, object], **changes: object) -> dict[str, np.ndarray]:
    """Simulated forces of all designs, by path and under ``forces``, [4, runs] and [4, runs, 3]."""
    paths = {path: [values(name)[path] for name in DESIGNS] for path in NAMES}
    table = sandbox.sweep(
        "guided_finger", set={"run.duration": "2.5 s", **changes}, audit=False,
        vary=[{"design": "paired", "over": paths}, *({"over": {path: value}} for path, value in
                                                     others.items())],
        keep=[f"{name}=mean finger.{name}.contact.normal over last 0.1 s" for name in PHALANGES])
    found = {path: table[path].reshape(len(DESIGNS), -1) for path in others}
    return found | {"forces": np.stack([table[name] for name in PHALANGES], axis=-1).reshape(
        len(DESIGNS), -1, 3)}


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    quick, found = options.quick, {}
    study = json.loads((HERE / "guides.json").read_text(encoding="utf-8"))
    figure, axes = panels(1, 1, 6.0, 3.0)
    for goal, name, runs, page in (("spread_one", "at one pull", 600, 0.0403),
                                   ("spread", "at three pulls", 1200, 0.0608)):
        study["search"]["best"] |= {"least": goal, "runs": 12 if quick else runs}
        chosen = sandbox.search.study(study)
        best = found[goal] = next(iter(chosen.best[0].objectives.values()))
        print(f"search for the smallest {goal}: {best:.4f} after {chosen.runs} runs (page: {page})")
        axes[0, 0].plot(np.fmin.accumulate(chosen.history[:, 0]), label=name)
    axes[0, 0].set(xlabel="run", ylabel="smallest spread so far", ylim=(0, 0.5))
    save(figure, options.out / "study_guides_search.png")
    mm = [12, 16, 20] if quick else list(range(8, 31, 2))
    discs = forces({"parameters.radius": [f"{r} mm" for r in mm],
                    "parameters.pull": [f"{pull} N" for pull in PULLS]})
    radius, pull = discs["parameters.radius"][0], discs["parameters.pull"][0]
    inside = (radius > 11 * MM) & (radius < 21 * MM)
    rows = [spread(discs["forces"][:, inside & (pull == each)]).mean(axis=1) for each in PULLS]
    if not quick:
        sides = {"parameters.radius": [f"{r} mm" for r in range(8, 21, 2)]}
        others = [discs["forces"][:, (pull == PULL) & (radius < 11 * MM)],
                  discs["forces"][:, (pull == PULL) & (radius > 21 * MM)],
                  forces(PLACES)["forces"], forces(sides, **SQUARE)["forces"]]
        rows += [spread(each).mean(axis=1) for each in others]
    for name, row in zip(DESIGNS, np.transpose(rows).tolist(), strict=True):
        print(f"{name}: {' '.join(f'{x:.2f}' for x in row)} (page: "
              f"{' '.join(f'{x:.2f}' for x in PAGE[name])})")
        found |= {f"{name}, {each} N": x for each, x in zip(PULLS, row, strict=False)}
    figure, axes = panels(1, 3, 8.0, 2.6)
    curves, over = panels(1, 1, 6.0, 3.2)
    fine = np.linspace(2.5, 15, 40)
    for k, name in enumerate(DESIGNS):
        given = values(name)
        exact = np.array([closed(given, 16 * MM, each) for each in fine])
        over[0, 0].plot(fine, np.where((exact < 0).any(axis=1), np.nan, spread(exact)), f"C{k}")
        at = np.isclose(radius, 16 * MM)
        over[0, 0].plot(pull[at], spread(discs["forces"][k, at]), f"oC{k}", label=name)
        for i, phalanx in enumerate(PHALANGES) if k else ():
            exact = np.array([closed(given, r * MM, PULL)[i] for r in mm])
            axes[0, k - 1].plot(mm, exact, f"C{i}")
            axes[0, k - 1].plot(mm, discs["forces"][k, pull == PULL, i], f"oC{i}", label=phalanx)
            axes[0, k - 1].set(title=name, ylim=(0, 2.5), xlabel="radius of the disc [mm]")
    axes[0, 0].set_ylabel("force at 3.75 N [N]")
    over[0, 0].set(xlabel="pull [N], disc of 16 mm", ylabel="spread of the forces")
    save(figure, options.out / "study_guides_forces.png")
    save(curves, options.out / "study_guides_pulls.png")
    shown = [(name, r) for name in ("Set G", "best at three pulls") for r in (12, 20)]
    stills(options.out / "study_guides_fingers.png", [sandbox.simulate(sandbox.load_scene(
        "guided_finger", overrides=values(name) | {"parameters.radius": r * MM}))
        for name, r in shown], [f"{name}, disc of {r} mm" for name, r in shown], 2)
    error = values("best at three pulls") | {"parameters.distal_y": -1.05 * MM}
    off = np.mean([spread(closed(error, r * MM, each)) for r in (12, 16, 20) for each in PULLS[:3]])
    print(f"guide of the tip off by 0.5 mm: {off:.2f} (page: 0.20)")
    return found | {"half a millimetre": float(off)}


if __name__ == "__main__":
    main()
