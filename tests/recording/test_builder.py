import gc
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from sandbox.errors import OutputError
from sandbox.kinds.arrays import PER_SAMPLE, STATIC
from sandbox.recording import archive
from sandbox.recording.builder import RecordingBuilder
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status

from .sample import CONTACTS, DISC, DISTAL, INFO, N, arrays, mechanism


def build(mech, *, contacts=CONTACTS, stop=N, **options):
    """A recording made the engine's way, sample by sample."""
    source = arrays(mech, contacts=contacts)
    builder = RecordingBuilder(mech, N, {key: source[key] for key in STATIC}, **options)
    for k in range(stop):
        for key in PER_SAMPLE:
            builder.arrays[key][k] = source[key][k]
        rows = source["contact_sample"] == k
        builder.contacts.append(
            k, source["contact_body"][rows], source["contact_other"][rows],
            source["contact_point"][rows], source["contact_force"][rows],
            source["contact_normal"][rows], source["contact_gap"][rows],
            source["contact_merged"][rows])
    return builder


def in_order(rows):
    return sorted(rows, key=lambda row: row[:3])


@pytest.mark.parametrize("memory", [1e9, 1000.0, 0.0])
def test_what_is_built_is_what_was_written(memory, tmp_path):
    mech = mechanism()
    rows = in_order(CONTACTS)
    run = build(mech, contacts=rows, memory=memory, directory=tmp_path).finish(N, INFO)
    expected = arrays(mech, contacts=rows)
    assert set(run.arrays) == set(expected)
    for key, array in expected.items():
        assert np.array_equal(run.arrays[key], array), key
    assert bool(list(tmp_path.iterdir())) == (memory < 1e9)


def test_rows_come_out_in_order_of_sample_body_and_other():
    run = build(mechanism(), contacts=CONTACTS).finish(N, INFO)
    keys = list(zip(*(run.arrays[f"contact_{k}"].tolist() for k in ("sample", "body", "other")),
                    strict=True))
    assert keys == sorted(row[:3] for row in CONTACTS)
    assert run.arrays["contact_force"].tolist() == [list(row[3]) for row in in_order(CONTACTS)]


def test_rows_that_came_in_order_are_handed_on_and_not_copied():
    """However many there are: what the engine writes is in order, and is held once."""
    for rows, shared in ((in_order(CONTACTS), True), (CONTACTS, False)):
        builder = build(mechanism(), contacts=rows)
        run = builder.finish(N, INFO)
        for key, column in builder.contacts.columns.items():
            assert np.shares_memory(run.arrays[key], column) is shared


def test_a_run_that_stops_early_keeps_what_it_has():
    builder = build(mechanism(), contacts=in_order(CONTACTS), stop=3)
    run = builder.finish(2, replace(INFO, status=Status.UNFINISHED))
    assert len(run) == 2
    assert not run.complete
    assert np.array_equal(run.time, arrays(mechanism())["time"][:2])
    assert run.arrays["contact_sample"].tolist() == [1, 1]


def test_what_was_never_written_is_nan():
    builder = build(mechanism(), stop=1)
    run = builder.finish(2, INFO)
    assert np.isfinite(run["disc.x"][0])
    assert np.isnan(run["disc.x"][1])


@pytest.mark.parametrize("memory", [1e9, 0.0])
def test_contact_rows_grow_as_needed(memory, tmp_path):
    mech = mechanism()
    builder = build(mech, contacts=(), memory=memory, directory=tmp_path)
    rng = np.random.default_rng(3)
    force = rng.normal(size=(5000, 2))
    up = np.tile([0.0, 1.0], (5000, 1))
    for k in range(N):
        part = slice(k * 250, (k + 1) * 250)
        body = np.full(250, DISTAL)
        builder.contacts.append(k, body, body + 1, force[part], force[part], up[part],
                                force[part, 0], up[part, 1])
    run = builder.finish(N, INFO)
    assert np.array_equal(run.arrays["contact_force"], force)
    assert np.array_equal(run.arrays["contact_gap"], force[:, 0])
    assert np.array_equal(run.arrays["contact_sample"], np.repeat(np.arange(N), 250))
    # sums of 250 terms of size 3, each off by at most 4e-16 times the partial sum
    expected = np.abs(force[:, 1]).reshape(N, 250).sum(axis=1)
    assert np.allclose(run["finger1.distal/disc.normal"], force[:, 1].reshape(N, 250).sum(axis=1),
                       rtol=0, atol=1e-11)
    assert np.allclose(run["disc.contact.normal"], expected, rtol=0, atol=1e-11)


def test_rows_of_many_samples_can_be_added_at_once():
    builder = build(mechanism(), contacts=())
    sample, body, palm = np.array([3, 3, 7]), np.array([DISTAL, DISC, DISC]), np.zeros(3, int)
    pair = np.ones((3, 2))
    builder.contacts.append(sample, body, palm, pair, pair, pair, np.zeros(3), np.ones(3))
    run = builder.finish(N, INFO)
    assert run.arrays["contact_sample"].tolist() == [3, 3, 7]
    assert run.arrays["contact_body"].tolist() == [DISTAL, DISC, DISC]


def test_files_live_as_long_as_the_recording_and_no_longer(tmp_path):
    mech = mechanism()
    run = build(mech, memory=0, directory=tmp_path).finish(N, INFO)
    part = run.part(2, 5)
    gc.collect()
    assert list(tmp_path.iterdir())
    del run
    gc.collect()
    assert np.array_equal(part.time, arrays(mech)["time"][2:5])
    assert list(tmp_path.iterdir())
    del part
    gc.collect()
    assert not list(tmp_path.iterdir())


def test_a_recording_in_files_is_saved_the_same(tmp_path):
    mech = mechanism()
    build(mech).finish(N, INFO).save(tmp_path / "a")
    build(mech, memory=0, directory=tmp_path).finish(N, INFO).save(tmp_path / "b")
    assert (tmp_path / "a/run.npz").read_bytes() == (tmp_path / "b/run.npz").read_bytes()
    assert len(Recording.load(tmp_path / "b")) == N


def test_no_room_is_told_before_anything_runs(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.posix_fallocate", full, raising=False)
    with pytest.raises(OutputError, match=r"no room for .* GB of samples in .*: No space left"):
        build(mechanism(), memory=0, directory=tmp_path)
    with pytest.raises(OutputError, match="cannot make a temporary directory"):
        build(mechanism(), memory=0, directory=tmp_path / "missing")


def test_a_long_run_is_not_held_twice(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "CHUNK", 1 << 20)
    mech, n = mechanism(), 20_000
    source = arrays(mech, n=1)
    builder = RecordingBuilder(mech, n, {key: source[key] for key in STATIC})
    builder.arrays["time"][:] = np.arange(n)
    held = sum(array.nbytes for array in builder.arrays.values())
    assert held > 8e6
    tracemalloc.start()
    run = builder.finish(n, INFO)
    with (tmp_path / "run.npz").open("wb") as file:
        archive.write(run, file)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < held / 2
