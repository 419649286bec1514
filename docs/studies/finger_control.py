"""Section 5 of the paper: pull and spring stiffness lead a finger to three angles at once.

Runs the controllers of Figures 18 to 21 and two faster ones, and compares where they end with the
closed form: joint i rests where T h_i = k_i s_i, s_i = dl_i hm_i (equations 17, 29 and 30).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import HINGES, ClosedForm, arguments, panels, save

import sandbox

TARGET = np.radians([5.0, 10.0, 15.0])
FACTORS = (0.5, 6.0)  # limits of the controlled stiffness, in shares of Table 2's
BAND = 0.02  # a rotation within 2 % of its target has settled
SCENES = {  # scene: settling time on the page [s]
    "finger_force_control": np.inf, "finger_stiffness_15N": 1.897, "finger_stiffness_10N": 1.450,
    "finger_stiffness_too_weak": np.inf, "finger_dual_control": 2.392,
    "finger_model_control": 0.070, "finger_lqr_control": 0.067,
}


def angles(run: sandbox.Recording) -> np.ndarray:
    """Rotations over time [rad], shape [samples, 3]."""
    return np.stack([run[f"finger.{hinge}.angle"] for hinge in HINGES], axis=1)


def settling(run: sandbox.Recording, until: float = np.inf) -> float:
    """Last time at which a rotation is outside its band [s]; inf if that is the end."""
    before = run.time <= until
    outside = (np.abs(angles(run)[before] / TARGET - 1) > BAND).any(axis=1)
    last = int(np.flatnonzero(outside)[-1])
    return float("inf") if last == len(outside) - 1 else float(run.time[last + 1])


def held(pull: float) -> sandbox.Recording:
    """The stiffness controllers at a constant pull [N], until they have settled."""
    return sandbox.simulate(sandbox.load_scene("finger_stiffness_15N", overrides={
        "parameters.pull": pull, "run.duration": 6, "run.step": 4e-4, "run.sample_rate": 100,
        "expect": []}))


def finger() -> tuple[ClosedForm, float, float]:
    """The finger, and the least and the largest pull that can hold the target [N]."""
    part = next(iter(sandbox.load_scene("finger_stiffness_15N").parts))
    form = ClosedForm(part)
    per_pull = form.tendon.arms(TARGET) / form.spring_moments(TARGET)
    low, high = (factor * form.stiffness / per_pull for factor in FACTORS)
    return form, float(low.max()), float(high.min())


def least_pull(low: float, high: float, within: float) -> tuple[float, float]:
    """Bisect between a pull that fails and one that reaches the target [N]."""
    while high - low > within:
        middle = (low + high) / 2
        reached = np.abs(angles(held(middle))[-1] / TARGET - 1).max() < 1e-3
        low, high = (low, middle) if reached else (middle, high)
    return low, high


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    form, lowest, highest = finger()
    found = {"lowest pull": lowest, "highest pull": highest}
    print(f"pulls that hold 5/10/15 deg, closed form: {lowest:.3f} to {highest:.2f} N")
    print(f"{'scene':26} {'rotations [deg]':>20} {'pull [N]':>9} {'settled [s]':>12} {'page':>7}"
          f" {'overshoot':>10}")
    for scene, page in SCENES.items():
        run = sandbox.simulate(sandbox.load_scene(scene))
        # finger_model_control and finger_lqr_control load the finger once it has settled
        event = min((each.time for each in run.info.events), default=np.inf)
        time, theta = settling(run, event), angles(run)
        ends = theta[run.time <= event][-1]
        overshoot = float((theta[run.time <= event] / TARGET - 1).max())
        pull = float(run["pull.value"][-1])
        print(f"{scene:26} {'/'.join(f'{x:.3f}' for x in np.degrees(ends)):>20} {pull:9.3f} "
              f"{time:12.3f} {page:7.3f} {overshoot:10.0%}")
        found[f"{scene} settled"] = time
        stiffness = pull * form.tendon.arms(ends) / form.spring_moments(ends)
        if "k1.value" in run and event == np.inf:
            found[f"{scene} stiffness"] = max(abs(run[f"k{i + 1}.value"][-1] / stiffness[i] - 1)
                                              for i in range(3))
        run.plot("finger.tendon.shortening", *(f"finger.{hinge}.angle" for hinge in HINGES),
                 "k?.value", "pull.value").savefig(
            options.out / f"{scene}.png", dpi=110)
    pulls = np.linspace(4, 9, 3 if options.quick else 11)
    knuckle = [float(np.degrees(angles(held(pull))[-1, 0])) for pull in pulls]
    low, high = least_pull(6.5, 7.2, 0.1 if options.quick else 0.01)
    print(f"least pull: closed form {lowest:.3f} N, by simulation {low:.3f} to {high:.3f} N")
    figure, axes = panels(1, 1, 6.0, 3.0)
    axes[0, 0].plot(pulls, knuckle, "o", label="simulated")
    axes[0, 0].axvline(lowest, linestyle="--", color="black", label=f"closed form {lowest:.3f} N")
    axes[0, 0].axhline(5, color="grey", linewidth=0.8)
    axes[0, 0].set(xlabel="pull [N]", ylabel="rotation of the knuckle at rest [deg]")
    save(figure, options.out / "least_pull.png")
    return found | {"least pull, low": low, "least pull, high": high}


if __name__ == "__main__":
    main()
