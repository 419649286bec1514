"""Cords as good as rigid, and what hangs on them by joint or by contact."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

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


ARM, TIP, BALL = 0.1, 0.2, 0.1
"""Where the ball lies and the cord is tied [m]; the ball's mass [kg]."""


def lever(light: float, step: float) -> Mechanism:
    """A ball on a level lever that a cord holds up at its tip; all start without stretch."""
    thick, radius = 0.005, 0.01
    bodies: list[dict[str, Any]] = [
        {"name": "wall", "motion": "fixed"},
        {"name": "lever", "mass": light, "centre": (TIP / 2, 0.0), "shapes": [
            {"type": "box", "size": (TIP, 2 * thick), "at": (TIP / 2, 0.0)}]},
        {"name": "ball", "mass": BALL, "at": (ARM, thick + radius), "shapes": [
            {"type": "circle", "radius": radius}]}]
    return spell(
        1.0, step, gravity=(0.0, -G), bodies=bodies,
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "lever", "on_b": (0.0, 0.0)}],
        tendons=[{"name": "cord", "stiffness": STIFF, "guides": [
            {"body": "lever", "at": (TIP, 0.0)}, {"body": "wall", "at": (TIP, 0.3)}]}])


def _lever(ratio: int) -> Trial:
    light = BALL / ratio

    def truth(run: Recording) -> np.ndarray:
        """Moments about the pin, with the ball where it has rolled to."""
        return G * (BALL * run["ball.x"] + light * TIP / 2) / TIP

    def mean(run: Recording) -> float:
        rest = late(run, 0.5)
        return float(abs((run["cord.tension"] / truth(run))[rest].mean() - 1))

    def scatter(run: Recording) -> float:
        rest = late(run, 0.1)
        return float((run["cord.tension"] / truth(run))[rest].std())

    def rise(run: Recording) -> float:
        return float((run["ball.y"] - 0.015).max())

    targets: list[Target] = []
    for step in STEPS:
        targets += [
            AtMost("mean tension error", step, 1e-3, "asked: moments about the pin"),
            AtMost("rise", step, 1e-6, "it falls with the lever's tip, by its cord's stretch"),
            AtMost("scatter of tension", step, 1e-6, "asked once the ringing has died")]
    return Trial(
        f"lever_{ratio}", f"100 g ball on a lever of {1e3 * light:g} g held up by a cord of "
        "1e5 N/m, 1 s", partial(lever, light),
        (Measure("mean tension error", "", mean), Measure("scatter of tension", "", scatter),
         Measure("rise", "m", rise)), tuple(targets))


def trials() -> list[Trial]:
    return [_hook(1000), _lever(1000)]
