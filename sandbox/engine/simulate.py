"""A run in one go."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sandbox.elements.controllers.custom import Custom, customs
from sandbox.engine.inspect_control import Checked, Runnable, checked
from sandbox.engine.pymunk_run import run_pymunk
from sandbox.engine.simulation import Simulation
from sandbox.errors import Interrupted, Problem, SceneError
from sandbox.recording.builder import RECORDED_BYTES
from sandbox.recording.recording import Recording


def simulate(
    scene: Runnable, *, progress: Callable[[float], None] | None = None,
    controllers: Sequence[Custom] = (), recorded_bytes: float = RECORDED_BYTES,
) -> Recording:
    """Run a scene from t = 0 and return its recording.

    Args:
        scene: a scene or an expanded mechanism, its control checked already or not; or what
            :func:`sandbox.load_scene` takes: a path, the name of a shipped scene, a mapping. Its
            ``run`` says how long and how finely.
        progress: called now and then with the fraction done, 0 to 1.
        controllers: Python callables that read and write while it runs, after the scene's own.
        recorded_bytes: the most that may be recorded, contacts included.

    Raises:
        SceneError: a scene that cannot be loaded; an input that cannot be computed at some time;
            a controller or an event that reads or writes what the mechanism does not have.
        SimulationDiverged: the motion stopped being finite; the error carries the recording.
        RecordingFull: more than allowed was recorded; the error carries the recording.
        ControllerFailed: a controller in Python raised an exception; the error carries the
            recording.
        Interrupted: Ctrl-C; the error carries the recording, if there was time for one.
    """
    try:
        mechanism = checked(scene, customs(controllers))
        if mechanism.run.solver == "pymunk":
            if controllers:
                raise SceneError([Problem("no-counterpart", "pymunk has no counterpart of a "
                                          "controller", "controllers",
                                          allowed="the solver 'direct'")])
            return run_pymunk(mechanism, progress=progress, recorded_bytes=recorded_bytes)
        simulation = Simulation(Checked(mechanism), controllers=controllers,
                                recorded_bytes=recorded_bytes)
    except KeyboardInterrupt:
        raise Interrupted(0.0) from None
    simulation.run(progress=progress)
    return simulation.recording()
