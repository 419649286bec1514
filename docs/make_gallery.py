"""Draw the pictures of renders/gallery/: ``python docs/make_gallery.py [NAME ...]``."""

from __future__ import annotations

import contextlib
import io
import json
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import sandbox
from sandbox.cli.commands import invoke
from sandbox.picture.palette import PUSH, TENSION
from sandbox.scene.library import shipped_scenes

FOLDER = Path(__file__).parent.parent / "renders" / "gallery"
HOW: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("gallery.toml").read_text(encoding="utf-8"))["pictures"]
"""How scenes are shown that are not shown at their end, without meters."""


@dataclass
class Work:
    """What several pictures share: runs by scene, and a place for their files."""

    folder: Path
    runs: dict[str, sandbox.Recording] = field(default_factory=dict)

    def run(self, scene: str) -> sandbox.Recording:
        """The run of a shipped scene."""
        if scene not in self.runs:
            self.runs[scene] = sandbox.simulate(sandbox.load_scene(scene))
        return self.runs[scene]


Draw = Callable[[Work, Path], None]


def film(scene: str, **how: Any) -> Draw:
    """A film of a scene's run, or a still of it, by the picture's ending; ``how`` of the render."""
    return lambda work, path: sandbox.render(work.run(scene), path, **how) and None


def small(scene: str) -> Draw:
    """The picture of a scene on docs/gallery.md: no title, no time; higher where its view is."""
    def draw(work: Work, path: Path) -> None:
        view = json.loads(shipped_scenes()[scene].read_text(encoding="utf-8")).get("view", {})
        width, height = view.get("size", (4, 3))
        how = HOW.get(scene, {})
        sandbox.render(work.run(scene), path, size=(400, 480 if height > width else 300), bare=True,
                       **how | {"meters": view.get("meters", [])[:how.get("meters", 0)]})
        slim(path)

    return draw


def study(name: str) -> Draw:
    """A picture that a script of docs/studies writes under the name of the picture."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / "studies" / name
        if not folder.is_dir():
            script = Path(__file__).parent / "studies" / f"{name}.py"
            subprocess.run([sys.executable, script, "--out", folder], check=True)
        shutil.copyfile(folder / path.name, path)

    return draw


def command(name: str, scene: str, *words: str) -> Draw:
    """The picture that ``sandbox equilibrium`` writes."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / name / scene
        if invoke([name, scene, *words, "--out", str(folder), "--quiet"]):
            raise SystemExit(f"sandbox {name} {scene} failed")
        shutil.copyfile(folder / ("rest.png" if name == "equilibrium" else f"{name}.png"), path)

    return draw


def lines(file: str, *said: str) -> Draw:
    """A picture that commands write, in a folder of their own."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / "lines" / path.stem
        folder.mkdir(parents=True)
        with contextlib.chdir(folder):
            for line in said:
                if invoke([*shlex.split(line), "--quiet"]):
                    raise SystemExit(f"sandbox {line} failed")
        shutil.copyfile(folder / file, path)

    return draw


BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: str) -> list[tuple[str, str]]:
    """Kind and text of each block of a page of the docs."""
    return BLOCK.findall((Path(__file__).parent / page).read_text(encoding="utf-8"))


def page_scene(page: str, n: int = 0, **how: Any) -> Draw:
    """A still of the n-th scene of a page of the docs; ``how`` of the render."""
    def draw(work: Work, path: Path) -> None:
        scene = work.folder / "scene.json"
        scene.write_text([text for kind, text in blocks(page) if kind == "json scene"][n])
        sandbox.render(sandbox.simulate(sandbox.load_scene(scene)), path, **how)

    return draw


def page_file(page: str, file: str, *, python: bool = False) -> Draw:
    """A picture that the commands of a page of the docs write, or its Python as well."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / "pages" / page
        if (folder / file).is_file():  # another picture's commands left it
            shutil.copyfile(folder / file, path)
            return
        folder.mkdir(parents=True, exist_ok=True)
        said = contextlib.redirect_stdout(io.StringIO())
        with contextlib.chdir(folder), said:
            for kind, text in blocks(page):
                if kind == "json scene":
                    Path("scene.json").write_text(text)
                if python and kind == "python":
                    exec(compile(text, page, "exec"), {"__name__": "__main__"})
                joined = text.replace("\\\n", "")
                for line in joined.splitlines() if kind == "console" else []:
                    if line.startswith("$ sandbox "):
                        invoke(shlex.split(line, comments=True)[2:])
        shutil.copyfile(folder / file, path)

    return draw


def sketched(draw: Callable[[Path], None]) -> Draw:
    """A drawing of docs/sketches.py."""
    def sketch(_work: Work, path: Path) -> None:
        draw(path)
        slim(path)

    return sketch


SKETCHES: dict[str, Callable[[Path], None]] = runpy.run_path(
    str(Path(__file__).with_name("sketches.py")))["SKETCHES"]
wholes: Callable[[str], list[str]] = runpy.run_path(
    str(Path(__file__).with_name("make_reference.py")))["wholes"]
"""What shows no run, by its file."""
TUTORIAL = {"hinge": 1.1, "four_bar": 1.9, "finger": "end", "differential": "end", "hand": "end"}
"""Of the last scenes of the pages in ``docs/tutorial``: the instant that is shown."""

HOWTO: dict[str, dict[str, Any]] = {
    "gripper": {"size": (640, 520)}, "gears": {"size": (640, 440)}, "belt": {"size": (640, 400)},
    "break": {"size": (640, 520)}, "conveyor": {"at": 0.1, "size": (640, 400)},
    "spring_table": {"at": 0.045, "size": (640, 440), "meters": ["stop.force", "trolley.vx"]},
    "motor": {"at": 0.3, "size": (640, 400)}, "cord_friction": {"at": 0.95, "size": (640, 440)},
}
"""Pages of ``docs/howto`` whose scene is shown, and how."""

LARGE = 80_000
"""Pictures of more bytes are kept with fewer colours."""

STUDIES = {
    "finger_control": ("finger_force_control", "finger_stiffness_15N", "finger_stiffness_10N",
                       "finger_stiffness_too_weak", "finger_dual_control", "finger_model_control",
                       "least_pull"),
    "proposals": ("proposals_maps", "proposals_pulls"),
    "hand_stiffness": ("hand_stiffness",), "soft_vs_adaptive": ("soft_hands", "soft_tensions"),
    "gripping_force": ("study_gripping_forces", "study_gripping_places", "study_gripping_hand"),
    "differential": ("study_differential_tensions", "study_differential_spread",
                     "study_differential_hands"),
    "survival": ("study_survival_ejection", "study_survival_adaptive", "study_survival_opposed"),
    "guides": ("study_guides_forces", "study_guides_pulls", "study_guides_search",
               "study_guides_fingers"),
    "sheaths": ("study_sheath_share", "study_sheath_spread", "study_sheath_loop"),
    "soft_skin": ("study_soft_skin",),
    "sand_heap": ("study_sand_heap", "study_sand_heap_shapes"),
    "identification": ("study_identification_motion", "study_identification_intervals"),
}
"""The pictures of each script of docs/studies."""

PICTURES: dict[str, Draw] = {
    **{f"{picture}.png": study(name) for name, pictures in STUDIES.items() for picture in pictures},
    **{f"{name}.png": film(name, at=HOW.get(name, {}).get("at"))
       for folder in ("hands", "mechanisms") for name in wholes(folder)},
    **{f"scenes/{name}.png": small(name) for name in shipped_scenes()},
    **{name: sketched(draw) for name, draw in SKETCHES.items()},
    "adaptive_grasp.gif": film("adaptive_grasp", fps=25),
    "shape_change.gif": film("shape_change", size=(580, 660), fps=20),
    "trebuchet.png": film("trebuchet", **HOW["trebuchet"]),
    "single_finger.png": film("single_finger"),
    "rocker_differential.png": film("rocker_differential"),
    "pulley_differential.png": film("pulley_differential"),
    "gear_pair.png": film("gear_pair", size=(640, 480)),
    "planetary.png": film("planetary", size=(640, 430)),
    "rolling_finger.png": film("rolling_finger", size=(600, 420)),
    "finger_joint_locks.png": film("finger_joint_locks", at=2.5),
    "held_disc.png": film("held_disc", at=0.6),
    "start_stronger.png": page_file("start.md", "stronger.png"),
    "scenes_first.png": page_scene("scenes.md", size=(640, 360)),
    "composing_chain.png": page_scene("composing.md", at=0.12, size=(640, 360)),
    "control_arm.png": page_scene("control.md", size=(640, 400)),
    "gym_swing.png": page_file("gym.md", "swing.png", python=True),
    "plots_finger.png": lines(
        "load.png", "run finger_model_control --no-render", "plot finger_model_control "
        "finger.mcp.angle finger.dip.angle k?.value --from 0.4s --to 700ms --out load.png"),
    "rest_finger.png": command("equilibrium", "single_finger"),
    "sweeps_pull.png": lines(
        "pull/sweep.png", "sweep single_finger --vary 'parameters.pull=2 N:8 N:7' --set "
        "run.duration=0.6s --keep 'finger.*/disc.normal' --out pull"),
    "scenes_lever.png": page_scene("scenes.md", 1, size=(640, 440)),
    **{f"tutorial_{name}.png": page_scene(f"tutorial/{name}.md", -1, at=instant)
       for name, instant in TUTORIAL.items()},
    "tutorial_hinge_wide.png": page_file("tutorial/hinge.md", "wide.png"),
    "tutorial_four_bar_torque.png": page_file("tutorial/four_bar.md", "torque.png"),
    "tutorial_finger_leaves.png": page_file("tutorial/finger.md", "leaves.png"),
    "tutorial_differential_ways.png": page_file("tutorial/differential.md", "ways.png"),
    "tutorial_hand_sweep.png": page_file("tutorial/hand.md", "pull/sweep.png"),
    "snap_through_rest.png": command("equilibrium", "snap_through", "--along",
                                       "parameters.load=0 N:1.5 N:21"),
    "sheathed_hand.png": film("sheathed_hand", at=1.9),
    **{f"howto_{name}.png": page_scene(f"howto/{name}.md", **how) for name, how in HOWTO.items()},
    "coming_from_working_model.png": page_scene(
        "coming_from/working_model.md", at=0.9, size=(640, 400)),
    "coming_from_mujoco.png": page_scene("coming_from/mujoco.md", at=0.15, size=(640, 400)),
    "howto_figure.png": page_file("howto/figure.md", "closing.png"),
    "howto_figure_sweep.png": page_file("howto/figure.md", "masses.png", python=True),
    "howto_sweep.png": page_file("howto/sweep.md", "throw/sweep.png"),
}


def slim(path: Path) -> None:
    """Keep a picture with 256 colours, those of tensions among them: a third of the bytes."""
    kept = np.array([*TENSION, *PUSH])
    with Image.open(path) as picture:
        full = picture.convert("RGB")
    common = full.quantize(256 - len(kept)).getpalette() or []
    palette = np.concatenate((np.reshape(common, (-1, 3))[:256 - len(kept)], kept))
    colours, back = np.unique(np.asarray(full).reshape(-1, 3), axis=0, return_inverse=True)
    nearest = ((colours[:, None].astype(int) - palette) ** 2).sum(axis=2).argmin(axis=1)
    fewer = Image.fromarray(nearest[back].reshape(full.size[::-1]).astype(np.uint8))
    fewer.putpalette(palette.ravel().tolist())
    fewer.save(path, optimize=True)


def main(names: list[str]) -> int:
    """Draw the named pictures, all by default; the exit code."""
    if unknown := sorted(set(names) - set(PICTURES)):
        sys.stderr.write(f"unknown: {', '.join(unknown)}; known: {', '.join(PICTURES)}\n")
        return 2
    (FOLDER / "scenes").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        work = Work(Path(folder))
        for name in names or PICTURES:
            path = FOLDER / name
            PICTURES[name](work, path)
            if path.suffix == ".png" and path.stat().st_size > LARGE:
                slim(path)
            sys.stdout.write(f"{name}: {path.stat().st_size / 1000:.0f} kB\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
