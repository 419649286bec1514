"""What each hand holds, from many starting places: ``python -m tests.scenes.holding [HAND …]``.

Prints the table of docs/hands.md: of the runs of a hand and an object the share in which it is held
to the end, goes less than :data:`HELD` when the shelf goes and when it is pushed, and the largest
way of those in which it goes further. ``--list`` adds these runs one by one.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator

from tests.scenes.test_hands import GOES, HANDS, HELD, gone, run

OBJECTS = ("disc", "square", "irregular", "l", "bottle")
BESIDE = (-5, -3, -1, 0, 2, 4, 5)
"""From the middle of the palm [mm]."""
BELOW = (2, 4, 7)
"""The palm [mm]."""
STEPS = (0.5, 1, 2)
"""[ms]."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("hands", nargs="*", default=HANDS)
    parser.add_argument("--list", action="store_true")
    given = parser.parse_args()
    print("| hand | " + " | ".join(OBJECTS) + " |", "|---" * (len(OBJECTS) + 1) + "|", sep="\n")
    for hand in given.hands:
        cells, lost = [], []
        for thing in OBJECTS:
            ways = list(_ways(hand, thing))
            out = [(*case, way) for *case, way, held in ways if way >= HELD or not held]
            cells.append(f"{len(ways) - len(out)} of {len(ways)}" + (
                f", {1e3 * max(way for *_, way in out):.2g} mm" if out else ""))
            lost += [f"  {thing}: beside {b} mm, below {d} mm, step {s} ms: {1e3 * way:.2g} mm"
                     for b, d, s, way in out]
        print(f"| `{hand}` | " + " | ".join(cells) + " |", flush=True)
        if given.list:
            print(*lost, sep="\n", flush=True)


def _ways(hand: str, thing: str) -> Iterator[tuple[float, float, float, float, bool]]:
    """Beside, below, step, how far it goes [m], and whether it is held all the time."""
    for beside, below, step in itertools.product(BESIDE, BELOW, STEPS):
        held = run(hand, object=f"object_{thing}", beside=f"{beside} mm", below=f"{below} mm",
                   step=f"{step} ms")
        rests = held["object.body.held"][held.time > 1.3].min() > 0
        yield beside, below, step, gone(held, GOES, 3.1), bool(rests)


if __name__ == "__main__":
    main()
