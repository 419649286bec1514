"""Code that studies share: their command line, figures, and a finger in closed form."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.image import imread

import sandbox
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import contact_forces, contact_jacobian
from sandbox.mechanics.tendon import route

HERE = Path(__file__).parent
HINGES, PHALANGES = ("mcp", "pip", "dip"), ("proximal", "middle", "distal")


def arguments(about: str | None, argv: Sequence[str] | None) -> argparse.Namespace:
    """The options of a study: ``out`` (a directory, created) and ``quick``."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--out", type=Path, default=Path("renders/studies"), help="for the figures")
    parser.add_argument("--quick", action="store_true", help="few runs, as a test")
    options = parser.parse_args(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    return options


def panels(rows: int, columns: int, width: float = 7.0, height: float = 2.6) -> tuple[Figure, Any]:
    """A figure and its axes, shape [rows, columns]; ``height`` of a row, in inches."""
    figure = Figure(figsize=(width, height * rows), layout="constrained", dpi=110)
    return figure, figure.subplots(rows, columns, squeeze=False)


def save(figure: Figure, path: Path) -> None:
    """Write a figure: one legend above panels with the same labels, otherwise one in each."""
    found = [(cell, *cell.get_legend_handles_labels()) for cell in figure.axes]
    found = [(cell, handles, labels) for cell, handles, labels in found if labels]
    if found and all(labels == found[0][2] for _, _, labels in found):
        _, handles, labels = found[0]
        figure.legend(handles, labels, loc="outside upper center", ncols=4, fontsize=8)
    else:
        for cell, *_ in found:
            cell.legend(fontsize=8)
    figure.savefig(path)


def stills(path: Path, runs: Sequence[sandbox.Recording], titles: Sequence[str], columns: int,
           size: tuple[int, int] = (400, 280)) -> None:
    """Draw the last instants of runs in a grid."""
    height = 7.0 / columns * size[1] / size[0] + 0.3
    figure, axes = panels(-(-len(runs) // columns), columns, height=height)
    with tempfile.TemporaryDirectory() as folder:
        for cell, run, title in zip(axes.flat, runs, titles, strict=True):
            sandbox.render(run, f"{folder}/still.png", at="end", size=size, bare=True)
            cell.imshow(imread(f"{folder}/still.png"))
            cell.set_title(title, fontsize=9)
            cell.set_axis_off()
    figure.savefig(path)


class ClosedForm:
    """Statics of a scene's finger; angles in rad, everything in SI, leading axes broadcast."""

    def __init__(self, part: Any) -> None:
        self.lengths, self.radii = np.array(part.lengths), np.array(part.radii)
        shape = (len(self.lengths), 2)
        self.tendon = route(part.guides, part.lengths)
        self.springs = spring_set(np.broadcast_to(part.springs.on_previous, shape),
                                  np.broadcast_to(part.springs.on_phalanx, shape))
        self.stiffness = np.broadcast_to(part.springs.stiffness, len(self.lengths))
        self.limits = np.array(part.limits)

    def spring_moments(self, theta: Any) -> Any:
        """Spring torques per stiffness, s = dl hm [m^2], of equations (29) and (30)."""
        return self.springs.elongations(theta) * self.springs.arms(theta)

    def torques(self, theta: Any, tension: Any) -> Any:
        """Joint torques T h - k s [N m]; tensions [N] have the leading axes of ``theta``."""
        pulled = np.asarray(tension)[..., None] * self.tendon.arms(theta)
        return pulled - self.stiffness * self.spring_moments(theta)

    def forces(self, theta: Any, distances: Any, tension: Any) -> Any:
        """Normal forces of all phalanges, J^-T (T h - k s) [N]."""
        return contact_forces(contact_jacobian(theta, self.lengths, distances),
                              self.torques(theta, tension))
