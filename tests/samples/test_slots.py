"""What is said of differentials that run out of travel: which, how far, when."""

import numpy as np
import pytest

import sandbox
from sandbox.samples.slots import AT_END, ended

RUN = {"run.duration": 0.8, "parts[tree].travel": "4 mm"}


@pytest.fixture(scope="module")
def stopped():
    return sandbox.simulate(sandbox.load_scene("four_finger_opposed", overrides=RUN))


def test_a_pivot_at_the_end_of_its_slot_is_told(stopped):
    """The way and the time are those of its recorded ``y``: the tree pulls upwards by 4 mm."""
    said = [note for note in stopped.notes if "end of its slot" in note]
    assert said
    name = said[0].split(" ")[0]
    gone = np.abs(stopped[f"{name}.y"] - stopped[f"{name}.y"][0])
    first = int(np.argmax(gone > 4e-3 - 2 * AT_END))
    assert gone[-1] == pytest.approx(gone[first], abs=1e-5)
    assert f"{name} reached the end of its slot, 4 mm from where it started, at t = " \
           f"{stopped.time[first]:.6g} s" in said[0]


def test_in_the_order_in_which_they_ended(stopped):
    times = [float(line.split("t = ")[1].split(" s")[0]) for line in ended(stopped)]
    assert times == sorted(times)


def test_with_room_nothing_is_told():
    run = sandbox.simulate(sandbox.load_scene(
        "four_finger_opposed", overrides={"run.duration": 0.8}))
    assert list(ended(run)) == []
