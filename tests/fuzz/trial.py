"""Take one untrusted input through every stage of the program.

Refusals (:class:`sandbox.SandboxError`) are what is wanted of a bad input; any other exception,
more time or more memory than allowed is a fault.
"""

from __future__ import annotations

import contextlib
import resource
import shutil
import tempfile
import time
import traceback
import warnings
from dataclasses import dataclass
from pathlib import Path

import sandbox
from sandbox.audit.audit import audit
from sandbox.engine.inspect import look_over
from sandbox.engine.inspect_control import Checked
from sandbox.figure import signals
from sandbox.figure.style import save_figure
from sandbox.samples.expectations import verdicts
from sandbox.samples.targets import response, targets
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import read_scene
from tests.fuzz import recordings
from tests.fuzz.inputs import make

STEPS, ENOUGH = 40, 1.0
"""Made of each scene that passes its checks, as many as begin within so long [s]: a run that moves
on can be watched and stopped, a step cannot."""
SECONDS = 5.0
"""The most that one input may take."""
MEGABYTES = 500
"""By which one may raise the most memory that the process has had."""


@dataclass(frozen=True)
class Outcome:
    """How far an input came, and what was wrong with that if anything was."""

    seed: int
    stage: str
    seconds: float
    fault: str = ""
    """Of sandbox; empty where the input was refused or all went well."""


def attempt(seed: int, *, recording: bool = False) -> Outcome:
    """Make an input from its seed, a scene or a recording, and take it through every stage."""
    began, came, fault = time.perf_counter(), ["make"], ""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder) / "scene.json"
        if recording:
            for name, content in recordings.make(seed).items():
                (path.parent / name).write_bytes(content)
        else:
            path.write_bytes(make(seed))
            shutil.copy(shipped_scenes()["jaw"], folder)  # which a shipped scene includes
        try:
            if recording:
                _look_at(Path(folder), came)
            else:
                _through(path, Path(folder), came)
        except sandbox.SandboxError as error:
            fault = "" if str(error).strip() else "a refusal without words"
        except Exception as error:
            fault = _told(error)
    seconds = time.perf_counter() - began
    if not fault and seconds > SECONDS:
        fault = f"took {seconds:.1f} s"
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    if not fault and grown > MEGABYTES:
        fault = f"needed {grown:.0f} MB"
    return Outcome(seed, came[-1], seconds, fault)


def _through(path: Path, folder: Path, came: list[str]) -> None:
    """Go through all stages; the name of each is added to ``came`` before it begins."""
    came.append("read")
    loaded = read_scene(path)
    came.append("inspect")
    found = look_over(loaded.mechanism)
    if any(problem.blocks for problem in found.problems) or any(found.estimate.beyond(Limits())):
        return
    came.append("simulate")
    simulation = sandbox.Simulation(Checked(loaded.mechanism))
    enough = time.perf_counter() + ENOUGH
    with contextlib.suppress(sandbox.SimulationDiverged):
        while simulation.steps < STEPS and time.perf_counter() < enough and simulation.step(1):
            pass
    run = simulation.recording()
    came.append("save")
    run.save(folder / "run")
    came.append("load")
    again = sandbox.Recording.load(folder / "run")
    if len(again):
        came.append("draw")
        sandbox.render(again, folder / "x.png")
    came.append("done")


def _look_at(folder: Path, came: list[str]) -> None:
    """Do with the run in ``folder`` what a reader would; as :func:`_through`."""
    came.append("load")
    run = sandbox.Recording.load(folder)
    came.append("read")
    for name in run.names():
        run.unit(name)
        run[name].sum()
    str(run.notes)
    came.append("judge")
    verdicts(run)
    came.append("audit")
    audit(run)
    if len(run) > 1:
        came.append("plot")
        names = [name for name in run.names() if run.unit(name) == "m"][:3]
        goals = targets(run)
        for name, goal in goals.items():
            response(run, name, goal)
        with contextlib.suppress(sandbox.OutputError):
            save_figure(signals.draw([signals.Plotted("run", run, goals)],
                                     names or run.names()[:1]), folder / "x.png")
    came.append("save")
    run.save(folder / "again")
    came.append("load again")
    sandbox.Recording.load(folder / "again")
    if len(run):
        came.append("draw")
        sandbox.render(run, folder / "end.png")
        came.append("film")
        sandbox.render(run, folder / "x.gif", speed=max(1e-9, float(run.time[-1]) / 0.2))
    came.append("done")


def _told(error: BaseException) -> str:
    """Type, message and place of an exception."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [each for each in frames if "/sandbox/" in each.filename]
    where = (own or frames)[-1]
    return (f"{type(error).__name__}: {str(error)[:120]} "
            f"({Path(where.filename).name}:{where.lineno})")
