"""How long arrows are: by what acts most of the time, not by the largest blow."""

import numpy as np
import pytest

from sandbox.draw.film.drives import DriveDrawer
from sandbox.draw.film.loads import LoadDrawer
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import LONGEST, ForceScale, largest_of, quantile, typical
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

TIME = np.arange(1000) / 1000


def test_a_quantile_weighs_by_time():
    """Of 1 for 9 s and 5 for 1 s the median is 1, the upper 5 % are 5."""
    values, weights = np.array([5.0, 1.0]), np.array([1.0, 9.0])
    assert quantile(values, weights, 0.5) == 1.0
    assert quantile(values, weights, 0.9) == 1.0
    assert quantile(values, weights, 0.95) == 5.0


def test_samples_that_lie_closer_together_count_less():
    """A blow that was sampled finely lasts no longer by that: 0.02 s of 1 s are 2 %."""
    fine = np.linspace(0.5, 0.52, 500)
    time = np.concatenate((np.linspace(0, 0.5, 50, endpoint=False), fine[:-1],
                           np.linspace(0.52, 1.0, 50)))
    size = np.where((time >= 0.5) & (time < 0.52), 100.0, 2.0)
    assert np.mean(size > 2) > 0.8
    assert typical(size, time) == 2.0


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


def test_what_lasts_at_the_end_counts_however_short_that_is():
    """4 % of the time is no more than a blow, but the run ends with it."""
    size = np.full(1000, 1.0)
    size[940:] = 3.0
    size[940:941] = 3e3
    assert typical(size[:], TIME) == 3.0
    size = np.full(1000, 1.0)
    size[-40:] = 3.0  # less than half of the last tenth
    assert typical(size, TIME) == 1.0


@pytest.mark.parametrize("size", [np.zeros(5), np.full(5, np.nan), np.zeros(1)])
def test_of_nothing_there_is_no_scale(size):
    assert typical(size, TIME[:len(size)]) == 0.0


def test_of_one_sample_it_is_the_largest():
    assert typical(np.array([4.0]), np.array([0.0])) == 4.0


def test_the_largest_of_each_sample():
    found = largest_of(np.array([0, 0, 2]), np.array([1.0, 4.0, 2.0]), 4)
    assert found.tolist() == [4.0, 0.0, 2.0, 0.0]


def driven(values):
    """A body with a force drive that has these values, one each millisecond."""
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "body", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}],
        "drives": [{"type": "force", "name": "push", "body": "body", "direction": [1, 0],
                    "value": 1}]})
    values = np.asarray(values, dtype=float)
    return recording(mechanism, np.arange(len(values)) / 1000, np.zeros((len(values), 1, 3)),
                     drive_value=values[:, None])


def test_the_arrow_of_a_drive_that_kicks_is_cut_and_the_others_stay_long():
    values = np.full(1000, 2.0)
    values[300] = 5e3
    pool = PointPool()
    drawer = DriveDrawer(driven(values), pool, 0.1, ForceScale(0.0, 0.0))
    pool.close()
    world = pool.world(np.zeros((1, 3)))
    lengths = {value: drawer.ends(world, np.array([value]))[0][2][0] for value in (2.0, 5e3)}
    assert lengths[2.0] == pytest.approx(0.1)
    # an arrow of a drive keeps half its length for its head
    assert lengths[5e3] == pytest.approx(0.1 * (0.5 + 0.5 * LONGEST))


def test_the_arrow_of_a_load_that_is_rarely_so_large_is_cut():
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "body", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}],
        "loads": [{"type": "drag", "name": "air", "bodies": ["body"], "linear": 1}]})
    force = np.zeros((1000, 1, 2))
    force[:, 0, 0] = 2.0
    force[300, 0, 0] = 5e3
    run = recording(mechanism, TIME, np.zeros((1000, 1, 3)), load_force=force)
    pool = PointPool()
    drawer = LoadDrawer(run, pool, 0.1, ForceScale(0.0, 0.0))
    pool.close()
    world = pool.world(np.zeros((1, 3)))
    tips = [drawer.arrows(world, sample)[0][2][0] for sample in (0, 300)]
    assert tips == pytest.approx([0.1, 0.1 * LONGEST])
