"""Draw the pictures of renders/gallery/: ``python docs/make_gallery.py [NAME ...]``."""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from PIL import Image

import sandbox
from sandbox.cli.entry import invoke
from sandbox.scene.library import wholes

FOLDER = Path(__file__).parent.parent / "renders" / "gallery"


@dataclass
class Work:
    """What several pictures share: runs by scene, studies by name, and a place for their files."""

    folder: Path
    runs: dict[str, sandbox.Recording] = field(default_factory=dict)

    def run(self, scene: str) -> sandbox.Recording:
        """The run of a shipped scene."""
        if scene not in self.runs:
            self.runs[scene] = sandbox.simulate(sandbox.load_scene(scene))
        return self.runs[scene]

    def study(self, name: str) -> Path:
        """The directory that a study filled."""
        folder = self.folder / "studies" / name
        if not folder.is_dir() and invoke(["study", name, "--out", str(folder), "--quiet"]):
            raise SystemExit(f"the study {name} failed")
        return folder


Draw = Callable[[Work, Path], None]


def film(scene: str, *, until: float | None = None, **how: Any) -> Draw:
    """A film or the last frame of a scene's run, by the picture's ending; ``until`` ends it [s]."""
    def draw(work: Work, path: Path) -> None:
        run = work.run(scene)
        end = len(run) if until is None else int((run.time <= until).sum())
        sandbox.render(run.part(0, end), path, **how)

    return draw


def figure(scene: str, name: str = "finger-control") -> Draw:
    """A figure of ``sandbox plot``."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / "runs" / scene
        work.run(scene).save(folder)
        if invoke(["plot", str(folder), "--figure", name, "--out", str(path), "--quiet"]):
            raise SystemExit(f"the figure of {scene} failed")

    return draw


def verification(case: str) -> Draw:
    """The picture of a case of ``sandbox verify``."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / "verification"
        if invoke(["verify", "--only", case, "--out", str(folder), "--quiet"]):
            raise SystemExit(f"the case {case} failed")
        shutil.copyfile(folder / path.name, path)

    return draw


def study(name: str, file: str) -> Draw:
    """A picture that ``sandbox study`` writes."""
    return lambda work, path: shutil.copyfile(work.study(name) / file, path) and None


def push(scene: str, *words: str) -> Draw:
    """The picture of ``sandbox push``."""
    def draw(work: Work, path: Path) -> None:
        folder = work.folder / "push" / scene
        if invoke(["push", scene, *words, "--out", str(folder), "--quiet"]):
            raise SystemExit(f"the pushes of {scene} failed")
        shutil.copyfile(folder / "push.png", path)

    return draw


MECHANISMS = {
    "slider_crank": 1.7, "coupler_curve": 1.55, "valve_cam": 0.53, "geneva_drive": 1.28,
    "planetary_gear": 2.0, "winch": 0.5, "atwood": 0.8, "toggle_press": 1.5, "truss": 0.5,
    "newtons_cradle": 0.75, "dominoes": 0.5, "car_on_bumps": 1.75, "escapement": 3.3,
    "projectile": 2.2,
    "trebuchet": 0.55,
}
"""Of the scenes in ``scenes/mechanisms``: the instant that is shown [s]."""

HANDS = {
    "four_finger_opposed": 1.7, "four_finger_thumb_fixed": 1.7, "four_finger_thumb_movable": 1.7,
    "prosthesis": 1.7,
}
"""Of the scenes in ``scenes/hands`` that are not shown at their end: the instant [s]."""

LARGE = 80_000
"""Pictures of more bytes are kept with fewer colours."""

PICTURES: dict[str, Draw] = {
    **{f"{name}.png": film(name, until=HANDS.get(name)) for name in wholes("hands")},
    **{f"{name}.png": film(name, until=instant) for name, instant in MECHANISMS.items()},
    "adaptive_grasp.gif": film("adaptive_grasp", fps=25),
    "shape_change.gif": film("shape_change", size=(704, 640), fps=20),
    "adaptive_grasp.png": film("adaptive_grasp"),
    "single_finger.png": film("single_finger"),
    "rocker_differential.png": film("rocker_differential"),
    "pulley_differential.png": film("pulley_differential"),
    "gear_pair.png": film("gear_pair", size=(640, 370)),
    "planetary.png": film("planetary", size=(480, 430)),
    "rolling_finger.png": film("rolling_finger", size=(600, 420)),
    "finger_joint_locks.png": film("finger_joint_locks", until=2.5),
    "finger_force_control.png": figure("finger_force_control"),
    "finger_stiffness_15N.png": figure("finger_stiffness_15N"),
    "finger_stiffness_10N.png": figure("finger_stiffness_10N"),
    "finger_stiffness_too_weak.png": figure("finger_stiffness_too_weak"),
    "finger_dual_control.png": figure("finger_dual_control"),
    "finger_model_control.png": figure("finger_model_control"),
    "held_disc.png": film("held_disc", until=0.6),
    "held_disc_push.png": push("held_disc", "--at", "0.15", "--set", "parameters.limit=0"),
    "grasp_states.png": verification("grasp_states"),
    "least_pull.png": study("least-pull", "least_pull.png"),
    "ideal_pull.png": study("ideal-pull", "ideal_pull.png"),
    "redundancy.png": study("redundancy", "redundancy.png"),
    "controllers.png": study("controllers", "controllers.png"),
    "controllers_motion.png": study("controllers", "controllers_motion.png"),
    "hand_stiffness.png": study("hand-stiffness", "hand_stiffness.png"),
    "soft_hands.png": study("soft-vs-adaptive", "soft_hands.png"),
    "soft_tensions.png": study("soft-vs-adaptive", "soft_tensions.png"),
    "proposals_maps.png": study("proposals", "proposals_maps.png"),
    "proposals_pulls.png": study("proposals", "proposals_pulls.png"),
}


def slim(path: Path) -> None:
    """Keep a picture with the 256 colours that are nearest to its own: a third of the bytes."""
    with Image.open(path) as picture:
        fewer = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    fewer.save(path, optimize=True)


def main(names: list[str]) -> int:
    """Draw the named pictures, all by default; the exit code."""
    if unknown := sorted(set(names) - set(PICTURES)):
        sys.stderr.write(f"unknown: {', '.join(unknown)}; known: {', '.join(PICTURES)}\n")
        return 2
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        work = Work(Path(folder))
        for name in names or PICTURES:
            path = FOLDER / name
            PICTURES[name](work, path)
            if path.suffix == ".png" and path.stat().st_size > LARGE:
                slim(path)
            sys.stdout.write(f"{path.name}: {path.stat().st_size / 1000:.0f} kB\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
