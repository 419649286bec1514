"""A puck that is pushed for a while, and workers without processes."""

from sandbox.sweeps.runner import run_point

PUCK = {
    "name": "puck", "gravity": [0, 0], "parameters": {"push": "2 N", "m": "1 kg"},
    "run": {"duration": "0.1 s", "step": "1 ms"},
    "bodies": [{"name": "puck", "mass": "=m", "shapes": [
        {"type": "circle", "radius": "10 mm"}]}],
    "drives": [{"name": "push", "type": "force", "body": "puck", "direction": [1, 0],
                "value": "=push"}],
    "expect": [{"final": "puck.vx", "above": 0.25}],
}


class InProcess:
    """Workers that are this process, in place of ``sandbox.sweeps.workers.Processes``."""

    def __init__(self, job, workers, stack):
        self._job = job

    def results(self, tasks):
        with self._job.bundle.unpacked() as scene:
            for id, values in tasks:
                yield run_point(self._job, scene, id, values)
