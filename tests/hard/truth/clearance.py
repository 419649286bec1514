"""A slider-crank whose slider has play between two guides: free flight, impacts, rest on a guide.

Flores, Leine and Glocker (2010), the slider kept level, without friction: its height y is that of
the rod's end, |y| <= play. At a guide Newton's law turns the speed of approach u into -e u; impacts
that come ever faster end with the slider on the guide, from where it leaves when it would be drawn
away without one. All instants are found by events of the integration.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from tests.hard.truth.integrate import ATOL, RTOL
from tests.hard.truth.linkages import Linkage
from tests.support.mechanisms import G
from tests.verification.test_clearance_benchmarks import PLAY, RESTITUTION
from tests.verification.test_linkages import CRANK, INERTIAS, MASSES, RATES, ROD

STILL = 3e-7
"""Speed after an impact [m/s] from which on the slider stays on the guide.

At 250 m/s^2 it flies 2e-16 m high, ten times what its height is rounded to.
"""


@dataclass(frozen=True)
class SliderWithPlay:
    """An open linkage whose last centre is the slider's."""

    free: Linkage
    play: float
    restitution: float

    @cached_property
    def held(self) -> Linkage:
        return replace(self.free, loops=(self.free.arms[-1],), slides=(True,))

    def height(self, y: np.ndarray) -> tuple[float, float, np.ndarray]:
        """Of the slider [m], its speed [m/s], and its Jacobian."""
        n = len(y) // 2
        turning = self.free.A[-1] * np.exp(1j * y[:n])
        row = (1j * turning).imag
        return float(turning.sum().imag), float(row @ y[n:]), row

    def drawn(self, y: np.ndarray) -> float:
        """Acceleration of the height that there would be without a guide [m/s^2]."""
        n = len(y) // 2
        turning = self.free.A[-1] * np.exp(1j * y[:n])
        alpha = self.free.acceleration(y[:n], y[n:])
        return float((1j * turning * alpha - turning * y[n:]**2).sum().imag)

    def struck(self, y: np.ndarray) -> np.ndarray:
        """The state after an impact."""
        n = len(y) // 2
        _, speed, row = self.height(y)
        J = self.free.A * (1j * np.exp(1j * y[:n]))
        m = np.array(self.free.masses)
        M = ((m[:, None] * J.conj()).T @ J).real + np.diag(self.free.inertias)
        way = np.linalg.solve(M, row)
        return np.concatenate([y[:n], y[n:] - (1 + self.restitution) * speed / (row @ way) * way])

    def _advance(self, now: float, end: float, y: np.ndarray, side: int) -> tuple[float, Any]:
        """Until something happens or ``end``: when that is, and the states up to then."""
        linkage, n = (self.held if side else self.free), len(y) // 2
        at, speed, _ = self.height(y)
        room = max(self.play, abs(at))  # struck, it may be beyond the guide by rounding

        def rate(_: float, state: np.ndarray) -> np.ndarray:
            return np.concatenate([state[n:], linkage.acceleration(state[:n], state[n:])])

        def inside(_: float, state: np.ndarray) -> float:
            return room - abs(self.height(state)[0])

        def pressed(_: float, state: np.ndarray) -> float:
            return side * self.drawn(state)

        event = pressed if side else inside
        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        back = -np.sign(at) * speed / max(abs(self.drawn(y)), 1.0)  # half of a short flight
        first = min(back / 4, end - now) if back > 0 and not side else None
        found = solve_ivp(rate, (now, end), y, method="DOP853", rtol=RTOL, atol=ATOL,
                          events=[event], dense_output=True, first_step=first)
        return float(found.t[-1]), found.sol

    def motion(self, times: np.ndarray) -> tuple[np.ndarray, list[float]]:
        """Angles and rates at ``times`` [s], shape [n, 2 bodies], and the instants of impacts."""
        y = np.array([*self.free.start, *self.free.rate], dtype=float)
        now, side, end, states, impacts = 0.0, 0, float(times[-1]), [], []
        while True:
            then, course = self._advance(now, end, y, side)
            states += [course(t) for t in times[(times > now) & (times <= then)]]
            if then >= end:
                return np.array(states), impacts
            now, y = then, course(then)
            if side:
                side = 0
                continue
            y = self.struck(y)
            impacts.append(now)
            at, speed, _ = self.height(y)
            if abs(speed) < STILL and np.sign(at) * self.drawn(y) > 0:
                side = int(np.sign(at))


TRUTH = SliderWithPlay(
    Linkage(masses=MASSES, inertias=INERTIAS[:2], gravity=G,
            arms=((CRANK / 2, 0.0), (CRANK, ROD / 2), (CRANK, ROD)), loops=(),
            start=(0.0, 0.0), rate=RATES),
    PLAY, RESTITUTION)
"""The mechanism of Flores, Leine and Glocker."""
