"""How long arrows are and how colours are scaled: by what acts most of the time."""

from __future__ import annotations

import numpy as np

from sandbox.picture.scales import quantile, typical
from sandbox.picture.tensions import largest_tension

TIME = np.arange(1000) / 1000


def test_a_quantile_weighs_by_time():
    """Of 1 for 9 s and 5 for 1 s the median is 1, the upper 5 % are 5."""
    values, weights = np.array([5.0, 1.0]), np.array([1.0, 9.0])
    assert quantile(values, weights, 0.5) == 1.0
    assert quantile(values, weights, 0.9) == 1.0
    assert quantile(values, weights, 0.95) == 5.0


def test_a_blow_gives_no_scale():
    size = np.full(1000, 2.0)
    size[500:540] = 1e4
    assert typical(size, TIME) == 2.0
    size[500:560] = 1e4  # more than one picture of twenty shows it
    assert typical(size, TIME) == 1e4


def test_only_the_time_in_which_anything_acts_counts():
    size = np.zeros(1000)
    size[100:110] = 7.0
    assert typical(size, TIME) == 7.0
    size[500] = 7e7  # of what rounding leaves beside that nothing is shown
    size[100:110] = 7.0
    assert typical(size, TIME) == 7e7


def test_a_short_spike_does_not_wash_out_what_is_carried_else() -> None:
    """5 % of the run at 100 N, the rest at 1 N: the top is what twice 1 N is rounded up to."""
    tension = np.where(np.arange(1000) < 50, 100.0, 1.0)[:, None]
    assert largest_tension(tension) == 2.0
    assert largest_tension(tension[::-1]) == 100.0  # the last picture is not beyond the scale
