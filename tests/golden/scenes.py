"""The scenes of the golden digest: shipped ones by name, those of README and docs by heading."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
PART = re.compile(r"^#+ (?P<heading>[^\n]+)$|^```(?P<kind>[^\n]*)\n(?P<text>.*?)^```$",
                  re.MULTILINE | re.DOTALL)
WHOLE = ("json scene", "json scene diverges")
"""Marks of blocks with a whole scene, of one that diverges on purpose, too."""


class Golden(NamedTuple):
    """A scene to simulate."""

    source: Path | str
    """A file, or the text of a block of the docs."""
    diverges: bool = False

    def mechanism(self) -> Mechanism:
        """The scene, expanded. Scenes that a block includes are copied beside it."""
        if isinstance(self.source, Path):
            return expand(load_scene(self.source))
        if '"include"' not in self.source:
            return expand(load_scene(json.loads(self.source)))
        with TemporaryDirectory() as folder:
            for path in shipped_scenes().values():
                shutil.copy(path, folder)
            path = Path(folder) / "scene.json"
            path.write_text(self.source, encoding="utf-8")
            return expand(load_scene(path))


def recording_of(mechanism: Mechanism) -> Recording:
    """The simulation of a mechanism, up to where it diverges."""
    try:
        return simulate(mechanism)
    except SimulationDiverged as error:
        if error.recording is None:
            raise
        return error.recording


def _of_page(page: Path) -> dict[str, Golden]:
    """The whole scenes of a page, by the page and the heading above."""
    found: dict[str, Golden] = {}
    heading = ""
    for part in PART.finditer(page.read_text(encoding="utf-8")):
        heading = part["heading"] or heading
        if part["kind"] in WHOLE:
            anchor = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            name = f"{page.name}#{anchor}"
            count = sum(other.partition("#")[2].partition("+")[0] == anchor for other in found)
            found[f"{name}+{count + 1}" if count else name] = Golden(
                part["text"], part["kind"].endswith("diverges"))
    return found


SHIPPED = {name: Golden(path) for name, path in shipped_scenes().items()}
SCENES = SHIPPED | {name: scene for page in PAGES for name, scene in _of_page(page).items()}
