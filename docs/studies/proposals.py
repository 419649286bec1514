"""The three proposals of the paper's conclusion: controlled springs, an antagonist, joint locks.

A joint of the free finger rests where T h = k s + T_a r + lock (from equations 17 and 29). Springs
alone hold an angle with T = k s / h. s / h rises up to the fold; beyond it a joint runs on to its
stop. All poses are reached slowly from the straight finger.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from common import HERE, HINGES, ClosedForm, arguments, panels, save

import sandbox

TARGET, PULLS = np.radians([5.0, 10.0, 15.0]), (5.0, 10.0, 15.0)
FACTOR, HOLDING = 3.0, 0.08  # stiffness range of elastomers; torque of a lock [N m]
ARM, GRID, TOP = 5e-3, 9501, (7, 66, 80)  # of the antagonist [m]; angles looked at; shown [deg]
INDEX = np.arange(GRID)[:, None]
PAGE = {5: (5.6, 7.2, 5.6), 10: (1.6, 8.6, 1.6), 15: (11.4, 10.8, 0.0)}  # distance to TARGET [deg]


class Reach:
    """Arms of the finger over its joints' angles, shape [angles, 3], and poses from them."""

    def __init__(self) -> None:
        form = ClosedForm(sandbox.load_scene(HERE / "proposals.json").parts[0])
        self.angle = np.linspace(0, form.limits[:, 1], GRID)
        self.h, self.s = form.tendon.arms(self.angle), form.spring_moments(self.angle)
        self.k = np.array(form.stiffness)
        falls = np.diff(self.s / self.h, axis=0) <= 0
        self.fold = np.where(falls.any(axis=0), falls.argmax(axis=0), GRID - 1)

    def at(self, values: np.ndarray, pose: np.ndarray = TARGET) -> np.ndarray:
        """Values at three angles [rad]."""
        return np.array([np.interp(pose[i], self.angle[:, i], values[:, i]) for i in range(3)])

    def rest(self, torque: np.ndarray) -> np.ndarray:
        """Index of the first angle without closing torque, or of the stop, shape [3]."""
        return np.where((torque <= 0).any(axis=0), (torque <= 0).argmax(axis=0), GRID - 1)

    def springs(self, pull: float) -> np.ndarray:
        """Angles that k0 to 3 k0 hold at a pull [N], as flags [angles, 3]."""
        stiff, soft = (self.rest(pull * self.h - f * self.k * self.s) for f in (FACTOR, 1.0))
        return (stiff <= INDEX) & (soft >= INDEX) & ((self.fold >= INDEX) | (INDEX == GRID - 1))

    def locks(self, pull: float) -> np.ndarray:
        """Angles on the way to rest at which a lock holds, as flags [angles, 3]."""
        load = pull * self.h - self.k * self.s
        free = self.rest(load)
        return (free >= INDEX) & ((load <= HOLDING) | (free == INDEX))

    def curve(self, pull: float) -> np.ndarray:
        """Poses over the tension of an antagonist of equal arms [rad], shape [tensions, 3]."""
        load = pull * self.h - self.k * self.s
        tensions = np.linspace(0, pull * self.h[0].max() / ARM, 601)
        return np.array([self.angle[self.rest(load - t * ARM), range(3)] for t in tensions])

    def miss(self, flags: np.ndarray) -> float:
        """Distance of the target from a box of poses, all joints together [deg]."""
        near = [np.abs(self.angle[on, i] - TARGET[i]).min() for i, on in enumerate(flags.T)]
        return float(np.degrees(np.linalg.norm(near)))

    def pulls(self) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Least pull at which each joint gets to the target, and by device the largest [N]."""
        h, s, k = self.at(self.h), self.at(self.s), self.k
        # an antagonist of constant arm adds no stiffness: stable up to T h' = k s'
        dh, ds = (self.at(np.gradient(v, axis=0)) for v in (self.h, self.s))
        return k * s / h, {"stiffness k0 to 3 k0": FACTOR * k * s / h,
                           "antagonist, wheels for the pose": np.where(dh > 0, k * ds / dh, np.inf),
                           "locks of 0.08 N m": (HOLDING + k * s) / h,
                           "locks of 0.05 N m": (0.05 + k * s) / h}


def confirm(reach: Reach) -> dict[str, float]:
    """Poses of the closed form against simulations: differences [deg]."""
    def simulate(**given: float) -> np.ndarray:
        run = sandbox.simulate(sandbox.load_scene(HERE / "proposals.json", overrides={
            f"parameters.{name}": value for name, value in given.items()}))
        return np.array([run[f"finger.{hinge}.angle"][-1] for hinge in HINGES])

    inside = np.radians([2.0, 10.0, 15.0])
    k1, k2, k3 = 10 / reach.at(reach.s / reach.h, inside)
    r1, r2, r3 = reach.at(14 * reach.h - reach.k * reach.s) / 10
    cases = {"springs for 2/10/15 deg": simulate(k1=k1, k2=k2, k3=k3) - inside,
             "antagonist on wheels made for the target": simulate(
                 pull=14, tension=10, r1=r1, r2=r2, r3=r3) - TARGET,
             "locks at the target": simulate(pull=15, holding=HOLDING) - TARGET}
    found = {name: float(np.degrees(np.abs(off).max())) for name, off in cases.items()}
    print("simulations less closed form [deg]:", {name: round(x, 4) for name, x in found.items()})
    return found


def main(argv: Sequence[str] | None = None) -> dict[str, float]:
    """Run the study; its numbers by name."""
    options, reach = arguments(__doc__, argv), Reach()
    figure, axes = panels(len(PULLS), 2, 7.0, 2.4)
    found: dict[str, float] = {}
    for row, pull in zip(axes, PULLS, strict=True):
        springs, locks, curve = reach.springs(pull), reach.locks(pull), reach.curve(pull)
        off = np.degrees(np.linalg.norm(curve - TARGET, axis=1).min())
        numbers = {"springs": reach.miss(springs), "antagonist": off, "locks": reach.miss(locks)}
        for (name, number), page in zip(numbers.items(), PAGE[int(pull)], strict=True):
            found[f"{name}, {pull:g} N"] = float(number)
            print(f"{pull:g} N, {name}: misses the target by {number:.1f} deg (page: {page})")
        for cell, (i, j) in zip(row, ((0, 1), (1, 2)), strict=True):
            x, y = np.degrees(reach.angle[::10, i]), np.degrees(reach.angle[::10, j])
            for flags, colour in ((locks, "C2"), (springs, "C0")):
                cell.contourf(x, y, np.outer(flags[::10, j], flags[::10, i]), [0.5, 1.5],
                              colors=colour, alpha=0.5)
            cell.plot(*np.degrees(curve[:, [i, j]].T), ".", color="C1", markersize=2,
                      label="antagonist")
            cell.plot(*np.degrees(TARGET[[i, j]]), "k+", markersize=10, label="target")
            for name, colour in (("springs", "C0"), ("locks", "C2")):
                cell.fill([], [], color=colour, alpha=0.5, label=name)
            cell.set(xlim=(0, TOP[i]), ylim=(0, TOP[j]), xlabel=f"{HINGES[i]} [deg]",
                     ylabel=f"{HINGES[j]} [deg]", title=f"{pull:g} N")
    save(figure, options.out / "proposals_maps.png")
    figure, axes = panels(1, 1, 6.5, 2.8)
    low, devices = reach.pulls()
    for y, (name, high) in enumerate(devices.items()):
        found[f"{name}, highest"] = float(high.min())
        print(f"{name}: holds all three joints from {low.max():.2f} to {high.min():.2f} N"
              if low.max() < high.min() else f"{name}: no pull holds all three joints")
        for i, hinge in enumerate(HINGES):
            axes[0, 0].barh(y + (i - 1) / 4, min(high[i], 45) - low[i], 0.2, low[i], color=f"C{i}",
                            label="" if y else hinge)
    axes[0, 0].set(xlabel="pull that holds the target [N]", xlim=(0, 45))
    axes[0, 0].set_yticks(range(len(devices)), list(devices), fontsize=8)
    save(figure, options.out / "proposals_pulls.png")
    return found | confirm(reach)


if __name__ == "__main__":
    main()
