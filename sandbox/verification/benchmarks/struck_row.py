"""Discs in a row that touch, the first one struck: which law of impact is followed."""

from __future__ import annotations

from sandbox.recording.recording import Recording
from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Digit, Json, spelled

RADIUS, WAY, APART = 0.01, 0.01, 0.1
"""Of the discs, of the first one before it strikes, between the rows [m]."""
ROWS = {
    (3, 1.0): (0.0, 0.0, 1.0),
    (5, 1.0): (0.0, 0.0, 0.0, 0.0, 1.0),
    (3, 0.5): (0.203125, 0.234375, 0.5625),
    (5, 0.5): (0.153870, 0.167175, 0.177979, 0.184570, 0.316406),
    (3, 0.0): (1 / 3,) * 3,
    (5, 0.0): (0.2,) * 5,
}
"""How many discs, restitution: their speeds in the end, of 1 m/s."""


def _name(row: int, disc: int) -> str:
    return f"row{row + 1}_disc{disc + 1}"


def scene(step: float) -> Json:
    """All rows on one smooth plane without weight."""
    bodies = [{"name": _name(row, i), "mass": 0.1, "material": f"e{e:g}".replace(".", "_"),
               "at": [2 * RADIUS * i - (0.0 if i else WAY), APART * row],
               "velocity": [0.0 if i else 1.0, 0.0],
               "shapes": [{"type": "circle", "radius": RADIUS}]}
              for row, (count, e) in enumerate(ROWS) for i in range(count)]
    return spelled(0.02, step, bodies=bodies, materials={
        f"e{e:g}".replace(".", "_"): {"friction": 0.0, "restitution": e} for _, e in ROWS})


def _speed(row: int, disc: int, count: int, e: float, expected: float) -> Digit:
    def found(run: Recording) -> float:
        return float(run[f"{_name(row, disc)}.vx"][-1])

    return Digit(f"{count} discs, e = {e:g}: disc {disc + 1}", expected, found)


STRUCK_ROW = Benchmark(
    "struck_row", "Row of touching discs",
    "Equal discs touch in a row; another runs into the first one at 1 m/s. With e = 1 three leave "
    "with (0, 0, 1) where impacts come one after the other, as in Newton's cradle, and with "
    "(−1/3, 2/3, 2/3) where all are reflected at once by Newton's law (Moreau). Both keep the "
    "momentum.",
    "Closed form of the law in sequence, the fastest approach first.",
    "Nothing; of the two laws this is the one that the engine follows.",
    scene, (1e-3, 5e-4, 2.5e-4),
    (Criterion("speeds in the end", "m/s",
               [_speed(row, i, count, e, v) for row, ((count, e), speeds) in enumerate(ROWS.items())
                for i, v in enumerate(speeds)],
               1.0, 1.0, "six digits; a blow hangs on no step", EXACT, 1e-6),),
    {"bodies[row1_disc2].mass": 0.1001})
BENCHMARKS = (STRUCK_ROW,)
