"""What does soft skin change in a grasp? Contact forces against the way the hand was closed.

With rigid contacts and friction, statics leaves the contact forces of a grasp open, and the way
there decides. Skin of stiffness k adds F = k d at every contact. The hand of ``soft_grasp`` closes
in four different times; what then differs between the forces is what the way decided.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import PHALANGES, arguments, panels, save

import sandbox

FINGERS = range(1, 5)
TIMES = ("0.2 s", "0.5 s", "1 s", "2 s")  # in which the pull rises
STIFFNESSES = (100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0)  # [N/mm]
PULL = 15.0  # [N]
LAST = "over last 0.1 s"
KEEP = [*(f"f{finger}_{phalanx}=mean finger{finger}.{phalanx}.contact.normal {LAST}"
          for finger in FINGERS for phalanx in PHALANGES),
        *(f"tension{finger}=mean finger{finger}.tendon.tension {LAST}" for finger in FINGERS),
        f"angle=mean finger1.mcp.angle {LAST}"]


def grasps(scene: str, times: Sequence[str], stiffness: Sequence[float] = ()) -> sandbox.Table:
    """One run for each stiffness [N/mm] and time of closing."""
    vary = {"parameters.stiffness": [f"{k} N/mm" for k in stiffness]} if stiffness else {}
    return sandbox.sweep(scene, vary=[{"over": {name: values}} for name, values in {
        **vary, "drives[actuator].value.ramp.over": list(times)}.items()], keep=KEEP,
        set={"run.duration": "3.5 s"}, audit=False)


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options = arguments(__doc__, argv)
    times = TIMES[::2] if options.quick else TIMES
    stiffnesses = (5.0,) if options.quick else STIFFNESSES
    names = [f"f{finger}_{phalanx}" for finger in FINGERS for phalanx in PHALANGES]

    def forces(table: sandbox.Table) -> np.ndarray:
        return np.stack([table[name] for name in names], axis=-1).reshape(-1, len(times), 12)

    rigid, soft = grasps("adaptive_grasp", times), grasps("soft_grasp", times, stiffnesses)
    spread = {"rigid": np.ptp(forces(rigid)[0], axis=0)} | {
        f"{k:g} N/mm": np.ptp(each, axis=0)
        for k, each in zip(stiffnesses, forces(soft), strict=True)}
    largest = [forces(rigid).max(), *forces(soft).max(axis=(1, 2))]
    angles = np.degrees(np.concatenate([rigid["angle"], soft["angle"]]).reshape(-1, len(times)))
    found = {}
    for (name, each), most, angle in zip(spread.items(), largest, angles, strict=True):
        found[f"spread, {name}"] = float(each.mean())
        print(f"{name}: forces differ by {each.mean():.2f} N on average, {each.max():.2f} N at "
              f"most; largest force {most:.2f} N; finger1 turns by "
              f"{np.abs(angle - angles[0]).max():.2f} deg")
    found["tension"] = max(float(np.abs(table[f"tension{finger}"] - PULL / 4).max())
                           for table in (rigid, soft) for finger in FINGERS)
    print(f"tensions are a quarter of the pull within {found['tension']:.1g} N")
    figure, axes = panels(1, 1, 6.0, 3.2)
    cell = axes[0, 0]
    for colour, (name, of) in zip(("C0", "C1"), {"mean": np.mean, "largest": np.max}.items(),
                                  strict=True):
        values = [float(of(each)) for each in spread.values()]
        cell.semilogx(stiffnesses, values[1:], "o-", color=colour, label=f"{name}, soft skin")
        cell.axhline(values[0], color=colour, linestyle="--", label=f"{name}, rigid")
    cell.set(xlabel="stiffness of the skin [N/mm]", ylabel="difference of forces [N]",
             ylim=(0, None))
    save(figure, options.out / "study_soft_skin.png")
    return found


if __name__ == "__main__":
    main()
