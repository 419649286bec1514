"""Pictures of an episode while it goes on, drawn as films are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.scales import force_scale
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism


class Pictures:
    """Frames of episodes of a scene, all with one camera.

    What nobody has seen yet cannot be fitted into the picture: the camera and the scale of forces
    are those of a run of the scene as it stands, unless its view says ``centre``, ``width`` and
    ``force_scale``. What would move from frame to frame is left out: legend, title, names, meters.

    Args:
        mechanism: the scene.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        view = mechanism.view.model_copy(update={
            "meters": (), "show": {**mechanism.view.show, "names": ()}})
        try:
            run = simulate(Checked(mechanism))
        except SimulationDiverged as error:
            run = error.recording or _first(mechanism)
        camera = FrameRenderer(run, view=view, bare=True).camera
        width = view.size[0] / camera.scale
        self._view = view.model_copy(update={
            "centre": camera.centre, "width": width,
            "force_scale": force_scale(run, width, view).metres})

    def now(self, simulation: Simulation) -> NDArray[np.uint8]:
        """Where a run stands: [height, width, 3]."""
        run = simulation.recording()
        if not len(run):
            run = _first(simulation.mechanism)
        frame = FrameRenderer(run, view=self._view, bare=True).draw(float(run.time[-1]))
        return np.ascontiguousarray(frame)


def _first(mechanism: Mechanism) -> Recording:
    """The first sample of a run."""
    simulation = Simulation(Checked(mechanism))
    while not len(run := simulation.recording()):
        simulation.step()
    return run
