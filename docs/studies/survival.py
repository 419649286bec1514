"""Which grasp survives? Maps over pose and friction of two hands, and of ejection in closed form.

Two phalanges l1, l2 on a tendon with arms h1, h2 (X = h2 / h1) press on a peg, without friction,
and at k2 on a disc of friction mu. The pose stays where the force on the peg is not negative:
k2 >= X l1 (cos theta_2 - mu sin theta_2) / (1 - X) - mu s, with s half the distal thickness.
Elsewhere the disc slides along the phalanx at a constant distance from the first hinge, until it is
on that curve or beyond the tip (ejected). For mu = 0 this is the grasp-state plane of Birglen,
Laliberte and Gosselin, Underactuated Robotic Hands (2008).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from common import HERE, arguments, panels, save

import sandbox

L1, L2, X, S, D = 50e-3, 33.3e-3, 0.5, 8e-3, 18e-3  # of survival_ejection.json [m]


def grid(file: str, x: tuple[str, float, float], y: tuple[str, float, float], of: str,
         sheets: Sequence[str], n: int) -> dict[str, np.ndarray]:
    """Results at the centres of n by n cells for each sheet, shape [sheets, n, n].

    ``file`` says the scene and what is kept; x and y are a path and its range.
    """
    study = json.loads((HERE / file).read_text(encoding="utf-8"))
    shares = (np.arange(n) + 0.5) / n
    over = {path: (low + shares * (high - low)).tolist() for path, low, high in (y, x)}
    table = sandbox.sweep(
        study["scene"], set=study.get("set"), keep=study["keep"], audit=False,
        vary=[{"over": {path: each}} for path, each in ({of: list(sheets)} | over).items()])
    shape = (len(sheets), n, n)
    return {name: np.array(table[name]).reshape(shape) for name in (*study["keep"], x[0], y[0])}


def curves(mu: np.ndarray, k2: np.ndarray, bend: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the pose stays, and where the disc is not ejected: above 0."""
    stays = k2 - X / (1 - X) * L1 * (np.cos(bend) - mu * np.sin(bend)) + mu * S
    edge = np.arccos((1 - X) * (L2 + mu * S) / (X * L1 * np.hypot(1, mu))) - np.arctan(mu)
    kept = ((L2 + L1 * np.cos(edge))**2 + (L1 * np.sin(edge) - D)**2
            - (k2 + L1 * np.cos(bend))**2 - (L1 * np.sin(bend) - D)**2)
    return stays, np.maximum(stays, kept)


def draw(path: Path, maps: Sequence[tuple[str, np.ndarray, np.ndarray | None]],
         x: tuple[str, float, float], y: tuple[str, float, float], columns: int) -> None:
    """Coloured cells where something holds, and the line of a closed form."""
    figure, axes = panels(-(-len(maps) // columns), columns, 8.0, 2.6)
    extent = (x[1], x[2], y[1], y[2])
    for cell, (title, holds, line) in zip(axes.flat, maps, strict=True):
        cell.imshow(holds, origin="lower", extent=extent, aspect="auto", cmap="RdYlBu", vmin=-0.3,
                    vmax=1.3)
        if line is not None:
            n = len(line)
            at = [(np.arange(n) + 0.5) / n * (high - low) + low for _, low, high in (x, y)]
            cell.contour(*at, line, levels=[0], colors="black")
        cell.set_title(title, fontsize=9)
        cell.set(xlabel=x[0], ylabel=y[0])
    line = "" if maps[0][2] is None else "; line: closed form"
    figure.suptitle(f"blue: holds; orange: does not{line}", fontsize=9)
    save(figure, path)


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    n, found = 4 if options.quick else 24, {}
    rubs = (0.0, 0.2, 0.4)
    x, y = ("parameters.k2", 2e-3, 33e-3), ("parameters.second", np.radians(2), np.radians(80))
    run = grid("survival_ejection.json", x, y, "parameters.mu", rubs, n)
    stays, kept = run["moved"] < np.radians(0.2), run["beyond"] < 0
    mu = np.reshape(rubs, (3, 1, 1))
    closed = curves(mu, run[x[0]], run[y[0]])
    # beside the curve a pose has not turned by 0.2 deg, or not passed the tip, when the run ends
    far = [np.abs(closed[0]) > 0.35e-3, np.abs(closed[1]) > 0.35e-3 * 2 * L1]
    found["differs"] = float(np.mean([(a != (b > 0))[c].mean() for a, b, c in zip(
        (stays, kept), closed, far, strict=True)]))
    for i, page in enumerate((("15.6 %", "16.3 %"), ("31.1 %", "7.1 %"), ("44.8 %", "3.0 %"))):
        found[f"stays {rubs[i]}"], lost = float(stays[i].mean()), float(1 - kept[i].mean())
        print(f"two phalanges, friction {rubs[i]}: the pose stays in {stays[i].mean():.1%}, "
              f"ejected {lost:.1%} (page: {', '.join(page)})")
    print(f"the closed form differs in {found['differs']:.2%} of the cells beside its curve")
    degrees = ("angle of the joint [deg]", 2, 80)
    draw(options.out / "study_survival_ejection.png", [
        (f"{name}, friction {friction:g}", holds[i], line[i]) for name, holds, line in (
            ("stays", stays, closed[0]), ("not ejected", kept, closed[1]))
        for i, friction in enumerate(rubs)], ("contact from the joint [mm]", 2, 33), degrees, 3)
    for name, file, x, label, friction, of, sheets, holds, pages in (
            ("adaptive grasp", "survival_adaptive.json", ("parameters.x", 0.0, 40e-3),
             ("circle beside the knuckle [mm]", 0, 40), "parameters.mu", "parameters.y",
             ("34 mm", "38 mm", "42 mm"), lambda run: run["pressed"] > 0.05, (91.7, 91.5, 92.0)),
            ("two against two", "survival_opposed.json", ("parameters.beside", -10e-3, 10e-3),
             ("disc beside the middle [mm]", -10, 10), "contacts[1].friction", "parameters.push",
             ("2 N", "5 N", "10 N"), lambda run: run["moved"] < 5e-3, (87.9, 62.5, 25.8))):
        size = 3 if options.quick else 24 if name == "adaptive grasp" else 16
        map_ = holds(grid(file, x, (friction, 0.0, 1.0), of, sheets, size))
        for i, (sheet, page) in enumerate(zip(sheets, pages, strict=True)):
            found[f"{name}, {sheet}"] = float(map_[i].mean())
            print(f"{name}, {sheet}: holds in {map_[i].mean():.1%} (page: {page} %)")
        draw(options.out / f"study_survival_{file.split('_')[1][:-5]}.png", [
            (f"{name}, {sheet}", map_[i], None) for i, sheet in enumerate(sheets)], label, (
                "friction", 0, 1), 3)
    return found


if __name__ == "__main__":
    main()
