"""Draw the pictures of renders/gallery/: ``python docs/make_gallery.py [NAME ...]``."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sandbox

FOLDER = Path(__file__).parent.parent / "renders" / "gallery"


@dataclass(frozen=True)
class Picture:
    """A scene and how it is drawn."""

    scene: str
    how: dict[str, Any]


PICTURES = {
    "adaptive_grasp.gif": Picture("adaptive_grasp", {"fps": 25}),
    "shape_change.gif": Picture("shape_change", {"size": (704, 640), "fps": 20}),
    "adaptive_grasp.png": Picture("adaptive_grasp", {}),
    "single_finger.png": Picture("single_finger", {}),
    "rocker_differential.png": Picture("rocker_differential", {}),
    "pulley_differential.png": Picture("pulley_differential", {}),
}


def main(names: list[str]) -> int:
    """Draw the named pictures, all by default; the exit code."""
    if unknown := sorted(set(names) - set(PICTURES)):
        sys.stderr.write(f"unknown: {', '.join(unknown)}; known: {', '.join(PICTURES)}\n")
        return 2
    FOLDER.mkdir(parents=True, exist_ok=True)
    runs: dict[str, sandbox.Recording] = {}
    for name in names or PICTURES:
        picture = PICTURES[name]
        if picture.scene not in runs:
            runs[picture.scene] = sandbox.simulate(sandbox.load_scene(picture.scene))
        path = FOLDER / name
        sandbox.render(runs[picture.scene], path, **picture.how)
        sys.stdout.write(f"{path.name}: {path.stat().st_size / 1000:.0f} kB\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
