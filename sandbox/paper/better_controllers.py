"""The paper's controllers against better ones, on the same finger, limits and targets.

Settling within 2 % (the last time that any joint is outside), overshoot, steady
error and effort: as modelled; at the worst of all corners of masses, damping and
springs' arms 20 % off; under a load on the fingertip from the start and as a step
after settling; with springs whose stiffness is limited in its rate; and with
encoders of 0.01 deg. Variants of these show what of the
difference is the gains', the pull's or the reference's. A stiffness can only
resist, so no controller closes the finger sooner than its softest springs let the
pull do it: that bound is in the table too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.paper.finger_plant import HINGES, SOFTEST, STIFFEST, TARGET, Plant
from sandbox.paper.finger_trials import (
    BETTER,
    CROSSING,
    GENTLE,
    LOAD,
    MODEL,
    PAPER,
    RETUNED,
    SPREAD,
    Mismatch,
    Trial,
    TrialController,
    corners,
    scene_of,
    trial,
)
from sandbox.paper.finger_variants import VARIANTS
from sandbox.recording.recording import Recording
from sandbox.samples.response import BAND
from sandbox.scene.read.load import load_scene
from sandbox.study.reference_fingers import SET_A

PICTURE, MOTION = "controllers.png", "controllers_motion.png"
NUMBERS, TABLE = "controllers.csv", "controllers.md"
PULLS = (14.0, 30.0)
"""For which the bound on the closing time is worked out [N]: that of the better controllers,
and the most that any controller may use."""
SHOWN, LEAST = 0.3, 1e-3
"""Of the motion [s], and of an error [%]."""
COLUMNS = (
    "controller", "settling_s", "overshoot_percent", "steady_error_percent",
    "worst_corner_settling_s", "worst_corner_overshoot_percent", "loaded_from_start_settling_s",
    "load_step_recovery_s", "worst_corner_load_step_recovery_s", "slow_springs_settling_s",
    "slow_springs_overshoot_percent", "encoder_settling_s", "encoder_stiffness_travel_k0",
    "stiffness_travel_k0", "stiffness_peak_k0", "stiffness_rate_k0_per_s", "pull_travel_N",
    "pull_rate_N_per_s")


@dataclass(frozen=True)
class Tried:
    """One controller in all cases."""

    controller: TrialController
    nominal: Trial
    corners: Sequence[Trial]
    loaded: Trial
    stepped: Trial
    """A load step after settling; settling is the recovery."""
    stepped_corners: Sequence[Trial]
    slow: Trial
    encoders: Trial

    @property
    def row(self) -> list[str | float]:
        """In the order of :data:`COLUMNS`."""
        plain, worst = self.nominal, self.corners
        return [
            self.controller.name, plain.settling, plain.overshoot, plain.steady_error,
            max(each.settling for each in worst), max(each.overshoot for each in worst),
            self.loaded.settling, self.stepped.settling,
            max(each.settling for each in self.stepped_corners), self.slow.settling,
            self.slow.overshoot, self.encoders.settling, self.encoders.stiffness.variation,
            plain.stiffness.variation, plain.stiffness.peak, plain.stiffness.rate,
            plain.pull.variation, plain.pull.rate]


@dataclass(frozen=True)
class Varied:
    """One variant in its case."""

    controller: TrialController
    case: Mismatch
    found: Trial

    @property
    def row(self) -> list[str | float]:
        """In the order of :data:`COLUMNS`; empty where it was not tried."""
        found = self.found
        cells: dict[str, str | float] = dict.fromkeys(COLUMNS, "")
        cells["controller"] = self.controller.name
        if self.case.slow:
            cells |= {"slow_springs_settling_s": found.settling,
                      "slow_springs_overshoot_percent": found.overshoot}
        else:
            cells |= {
                "settling_s": found.settling, "overshoot_percent": found.overshoot,
                "steady_error_percent": found.steady_error,
                "stiffness_travel_k0": found.stiffness.variation,
                "stiffness_peak_k0": found.stiffness.peak,
                "stiffness_rate_k0_per_s": found.stiffness.rate,
                "pull_travel_N": found.pull.variation, "pull_rate_N_per_s": found.pull.rate}
        return list(cells.values())


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Table (markdown and CSV) and picture into ``directory``.

    Raises:
        OutputError: a file cannot be written.
    """
    chosen = (*PAPER, RETUNED, *BETTER)
    tried = []
    for i, controller in enumerate(chosen):
        tried.append(in_all_cases(controller))
        if progress is not None:
            progress((i + 1) / len(chosen))
    varied = [Varied(controller, case, trial(controller, case)) for controller, case in VARIANTS]
    bounds = {pull: soonest(pull) for pull in PULLS}
    rows = [*(each.row for each in tried), *(each.row for each in varied)]
    _write(directory / NUMBERS, comma_separated(COLUMNS, rows, digits=6))
    _write(directory / TABLE, _markdown(tried, bounds) + _variants(varied))
    save_panels(directory / PICTURE, _errors(tried))
    save_panels(directory / MOTION, _motion(tried))
    return "\n".join([*(_line(each) for each in tried), *(
        f"{each.controller.name}: settles in {_time(each.found.settling)}, "
        f"overshoot {each.found.overshoot:.0f} %" for each in varied), *(
        f"softest springs at {pull:g} N: all joints in the band after {at:.4f} s at the soonest"
        for pull, at in bounds.items())])


def in_all_cases(controller: TrialController) -> Tried:
    """One controller tried in all cases."""
    settled = controller.duration
    return Tried(
        controller, trial(controller), [trial(controller, case) for case in corners()],
        trial(controller, Mismatch(load=LOAD)),
        trial(controller, Mismatch(load=LOAD, load_at=settled)),
        [trial(controller, Mismatch(case.mass, case.damping, case.arms, LOAD, settled))
         for case in corners()],
        trial(controller, Mismatch(slow=True)), trial(controller, Mismatch(read_in_steps=True)))


def soonest(pull: float) -> float:
    """When the slowest joint first comes within 2 % of its target on the softest springs [s].

    From straight and at rest, at a constant pull. A controller of stiffness cannot
    be quicker by much: it can only hold joints back (whether holding one back may
    speed up another, by inertia, is not excluded).
    """
    scene = scene_of(MODEL)
    scene["controllers"], scene["drives"] = [], scene["drives"][:1]
    scene["drives"][0]["value"] = pull
    scene["parts"][0]["springs"]["stiffness"] = Plant().softest.tolist()
    scene["run"] |= {"duration": 0.1, "step": 5e-5, "sample_rate": 20_000}
    free = simulate(load_scene(scene))
    first = [np.argmax(free[f"finger.{hinge}.angle"] >= (1 - BAND) * target)
             for hinge, target in zip(HINGES, TARGET, strict=True)]
    return float(free.time[max(first)])


# --- tables


def _write(path: Path, text: str) -> None:
    write_atomic(path, text)


def _markdown(tried: Sequence[Tried], bounds: dict[float, float]) -> str:
    heads = ["controller", "settling", "overshoot", "worst of 32 corners", "(overshoot)",
             "loaded from the start", "load step", "(worst corner)", "slow springs",
             "(overshoot)", "encoder 0.01°", "stiffness travel", "(with encoder)", "peak rate",
             "pull travel"]
    lines = ["# The finger under control", "",
             f"Settling: last time that any rotation is outside {100 * BAND:g} % of 5/10/15°. "
             f"Corners: masses, damping and each spring's arms {100 * SPREAD:g} % off. Load: "
             f"{LOAD:g} N across the fingertip. Slow springs: from k0 to 3 k0 in {CROSSING:g} s "
             f"at the fastest; the better controllers' pull then rises over {GENTLE:g} s. Travel: "
             "the sum of all changes, of the springs in shares of Table 2's stiffness k0.", "",
             f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    lines += [f"| {' | '.join(_cells(each))} |" for each in tried]
    dual = tried[len(PAPER) - 1].nominal.settling
    lines += ["", "Sooner than the paper's dual control, as modelled and at the worst corner: "
              + ", ".join(
                  f"{each.controller.name} {dual / each.nominal.settling:.0f} and "
                  f"{dual / max(t.settling for t in each.corners):.0f} times"
                  for each in tried[len(PAPER):]) + "."]
    lines += ["", "A stiffness can only resist. With the softest springs all the time the joints "
              "come into the band (and fly through it) after " + ", ".join(
                  f"{1e3 * at:.1f} ms at {pull:g} N" for pull, at in bounds.items()) + "."]
    return "\n".join(lines) + "\n"


def _variants(varied: Sequence[Varied]) -> str:
    """The second table."""
    heads = ["variant", "settling", "overshoot", "stiffness travel", "pull at the end"]
    lines = ["", "# Variants", "",
             "Gains only: the proportional and integral gains of the PID retuned, no derivative, a "
             "target that jumps. Tp and Ti: of the pull's loop. Loops retuned: those on the "
             f"stiffness. Pull rises, slower reference: over {GENTLE:g} s.", "",
             f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    lines += [f"| {each.controller.name} | {_time(each.found.settling)} | "
              f"{each.found.overshoot:.0f} % | {each.found.stiffness.variation:.1f} k0 | "
              f"{each.found.run['pull.value'][-1]:.2f} N |" for each in varied]
    return "\n".join(lines) + "\n"


def _cells(each: Tried) -> list[str]:
    (name, settling, over, _, worst, worst_over, loaded, step, worst_step, slow, slow_over,
     encoder, encoder_travel, travel, _, rate, pull, _) = each.row
    return [str(name), _time(settling), f"{over:.1f} %", _time(worst), f"{worst_over:.0f} %",
            _time(loaded), _time(step), _time(worst_step), _time(slow), f"{slow_over:.0f} %",
            _time(encoder), f"{travel:.1f} k0", f"{encoder_travel:.1f} k0", f"{rate:.0f} k0/s",
            f"{pull:.1f} N"]


def _time(value: float | str) -> str:
    return f"{1e3 * float(value):.0f} ms" if np.isfinite(float(value)) else "never"


def _line(each: Tried) -> str:
    cells = _cells(each)
    return (f"{cells[0]}: settles in {cells[1]}, overshoot {cells[2]}; worst corner {cells[3]}, "
            f"load step {cells[6]}, slow springs {cells[8]}")


# --- picture


def _error(run: Recording) -> Array:
    """The largest distance of any joint from its target over time, in % of it, shape [n]."""
    return np.asarray(np.max([
        100 * np.abs(run[f"finger.{hinge}.angle"] / target - 1)
        for hinge, target in zip(HINGES, TARGET, strict=True)], axis=0))


def _errors(tried: Sequence[Tried]) -> list[Panel]:
    last = max(each.nominal.run.time[-1] for each in tried)
    band = Curve("2 %", np.array([2e-3, last]), np.array([100 * BAND, 100 * BAND]), "dashed")
    shown = [each for each in tried if each.controller != PAPER[0]]
    plain = [Curve(_label(each), each.nominal.run.time, _seen(_error(each.nominal.run)))
             for each in shown]
    worst = [Curve(_label(each), each.nominal.run.time, _seen(np.max(
        [_error(corner.run) for corner in each.corners], axis=0))) for each in shown]
    y = "largest error of the three joints [%]"
    return [Panel("as modelled", "time [s]", y, [*plain, band], scale="log"),
            Panel(f"worst of 32 corners, ±{100 * SPREAD:g} %", "time [s]", y, [*worst, band],
                  scale="log")]


def _motion(tried: Sequence[Tried]) -> list[Panel]:
    """The first 0.3 s of the knuckle and of its spring."""
    shown = [each for each in tried if each.controller != PAPER[0]]
    angles, springs = [], []
    for each in shown:
        run, first = each.nominal.run, each.nominal.run.time <= SHOWN
        time = 1e3 * run.time[first]
        angles.append(Curve(_label(each), time, np.degrees(run["finger.mcp.angle"][first])))
        springs.append(Curve(_label(each), time, run["k1.value"][first] / SET_A.stiffness[0]))
    goal = Curve("target", np.array([0.0, 1e3 * SHOWN]), np.full(2, np.degrees(TARGET[0])),
                 "dashed")
    # one curve of two strokes
    limits = Curve("limits", np.array([0.0, 1e3 * SHOWN, np.nan, 0.0, 1e3 * SHOWN]),
                   np.array([STIFFEST, STIFFEST, np.nan, SOFTEST, SOFTEST]), "dashed")
    return [Panel("the knuckle, as modelled", "time [ms]", "rotation [deg]", [*angles, goal]),
            Panel("its spring", "time [ms]", "stiffness [k0]",
                  [*springs, limits])]


def _label(each: Tried) -> str:
    # curves whose names agree before a comma would share a colour
    return each.controller.name.replace(",", "")


def _seen(error: Array) -> Array:
    """What is large enough to be shown."""
    return np.where(error > LEAST, error, np.nan)
