import numpy as np
import pytest

from sandbox.samples import samples
from tests.recording.sample import CONTACTS, N, S, recording


@pytest.fixture(scope="module")
def run():
    return recording(contacts=CONTACTS)


def over(run, name):
    """The quantity in samples 0 to 4; the later ones have no contact at all."""
    assert run[name].shape == (N,)
    assert not run[name][5:].any()
    return run[name][:5].tolist()


def test_normal_and_tangential_split_of_a_force(run):
    # normal = f.u and tangential = f.(u turned by +90 degrees); u = (0, 1) turned is (-1, 0)
    assert over(run, "finger1.distal/disc.normal") == [0, 3.0, 0, 5e-7, 0]
    assert over(run, "finger1.distal/disc.tangential") == [0, 0.5, 0, 0, 0]
    # f = (2, 0) on u = (1, 1)/sqrt 2: normal sqrt 2, tangential -sqrt 2; one rounding each
    assert run["finger1.proximal/disc.normal"][2] == pytest.approx(2 * S, rel=1e-15)
    assert run["finger1.proximal/disc.tangential"][2] == pytest.approx(-2 * S, rel=1e-15)


def test_a_body_sums_magnitudes_over_its_pairs_and_both_sides(run):
    assert over(run, "finger1.distal.contact.normal") == [0, 4.0, 0, 5e-7, 0]
    assert over(run, "disc.contact.normal") == [0, 3.0, 2 * S + 4.0, 5e-7, 0]
    assert over(run, "disc.contact.tangential") == [0, 0.5, 2 * S + 0.25, 0, 0]


def test_resultant_follows_action_and_reaction(run):
    assert over(run, "finger1.distal.contact.fx") == [0, -0.5, 0, 0, 0]
    assert over(run, "finger1.distal.contact.fy") == [0, 3.0 + 1.0, 0, 5e-7, 0]
    assert over(run, "disc.contact.fx") == [0, 0.5, -2.0 + 0.25, 0, 0]
    total = sum(run[f"{body.name}.contact.fy"] for body in run.mechanism.bodies)
    assert np.array_equal(total, np.zeros(N))


def test_a_group_counts_outside_touches_only(run):
    # sample 1: distal on disc and the phalanges on each other; sample 3: below 1e-6 N
    assert over(run, "finger1.contact.count") == [0, 1, 1, 0, 0]
    assert over(run, "finger1.contact.normal") == pytest.approx([0, 3, 2 * S, 5e-7, 0], rel=1e-15)


@pytest.mark.parametrize("rows", [1, 3])
def test_many_rows_are_read_in_pieces_to_the_same_numbers(monkeypatch, rows):
    options = {"contacts": sorted(CONTACTS, key=lambda row: row[:3]), "meters": [
        {"name": "m", "value": "=disc.contact.normal + finger1.contact.count", "unit": "1"}]}
    whole = recording(**options)
    monkeypatch.setattr(samples, "ROWS", rows)
    pieces = recording(**options)
    for name in [*whole.names(), "finger1.distal/disc.normal"]:
        assert np.array_equal(pieces[name], whole[name], equal_nan=True), name
    spans = [len(part) for part in pieces.parts(7, rows=rows)]
    assert sum(spans) == len(whole)
    assert max(spans) <= 7
    assert all(len(part.arrays["contact_gap"]) <= max(rows, 2)
               for part in pieces.parts(7, rows=rows))


def test_picked_samples_have_their_own_rows():
    run = recording(contacts=sorted(CONTACTS, key=lambda row: row[:3]))
    some = run.pick(np.array([0, 2, 3, 9]))
    assert some.arrays["contact_sample"].tolist() == [1, 1, 2]
    assert np.array_equal(some["disc.contact.normal"], run["disc.contact.normal"][[0, 2, 3, 9]])
