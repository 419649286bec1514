"""Cords as good as rigid, and what hangs on them by joint or by contact."""

from __future__ import annotations

from typing import Any

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.measures import late
from tests.hard.trial import AtMost, Measure, Target, Trial, spell

G = 9.81
STIFF = 1e5
STEPS = (1e-3, 1e-4)


def hook(heavy: float, light: float, step: float) -> Mechanism:
    """A weight pinned under a light hook on a cord that is straight, and not stretched yet."""
    bodies: list[dict[str, Any]] = [
        {"name": "beam", "motion": "fixed"},
        {"name": "hook", "mass": light, "inertia": light * 1e-4, "at": (0.0, -0.1)},
        {"name": "weight", "mass": heavy, "inertia": heavy * 1e-3, "at": (0.0, -0.15)}]
    return spell(
        2.0, step, gravity=(0.0, -G), bodies=bodies,
        joints=[{"type": "pin", "name": "pin", "a": "hook", "b": "weight", "on_a": (0.0, -0.01)}],
        tendons=[{"name": "cord", "stiffness": STIFF,
                  "guides": [{"body": "hook"}, {"body": "beam"}]}])


def _hook(ratio: int) -> Trial:
    heavy = 0.5
    light = heavy / ratio
    load = (heavy + light) * G

    def mean(run: Recording, seconds: float) -> float:
        return float(abs(run["cord.tension"][late(run, seconds)].mean() / load - 1))

    measures = (
        Measure("mean tension error", "", lambda run: mean(run, 1.5)),
        Measure("rest tension error", "", lambda run: mean(run, 0.1)),
        Measure("peak tension", "weights", lambda run: float(run["cord.tension"].max() / load)),
        Measure("rise", "m", lambda run: float(max(
            run["hook.y"].max() + 0.1, run["weight.y"].max() + 0.15))))
    targets: list[Target] = []
    for step in STEPS:
        targets += [
            AtMost("mean tension error", step, 1e-3, "asked: T = (M + m) g"),
            AtMost("peak tension", step, 2.001, "T = W (1 - cos wt) of a cord without damping"),
            AtMost("rise", step, 1e-7, "no energy for more; a millionth of the size for gaps"),
            AtMost("rest tension error", step, 1e-6, "asked once the ringing has died")]
    return Trial(f"hook_{ratio}", f"0.5 kg pinned under a hook of {1e3 * light:g} g on a cord of "
                 "1e5 N/m, 2 s", lambda step: hook(heavy, light, step), measures, tuple(targets))


def trials() -> list[Trial]:
    return [_hook(1000)]
