import gc
import tracemalloc

import numpy as np
import pytest

from sandbox.elements.arrays import IMPACT, PER_SAMPLE, STATIC
from sandbox.errors import OutputError
from sandbox.recording.builder import RecordingBuilder

from .sample import CONTACTS, DISC, DISTAL, INFO, N, arrays, mapped, mechanism


@pytest.fixture
def budget(monkeypatch, tmp_path):
    """Sets the bytes that are kept in memory, and where files of the rest go."""
    def set_to(memory, directory=tmp_path):
        monkeypatch.setattr("sandbox.recording.builder.MEMORY", memory)
        monkeypatch.setattr("tempfile.tempdir", str(directory))
    return set_to


def build(mech, *, contacts=CONTACTS, stop=N):
    """A recording made the engine's way, sample by sample."""
    source = arrays(mech, contacts=contacts)
    builder = RecordingBuilder(mech, N, {key: source[key] for key in STATIC})
    for k in range(stop):
        builder.put(k, {key: source[key][k:k + 1] for key in PER_SAMPLE})
        rows = source["contact_sample"] == k
        builder.contacts.append(
            *(source[f"contact_{key}"][rows] for key in (
                "sample", "body", "other", "point", "force", "normal", "gap", "merged",
                "twist")))
    return builder


def times(n=N):
    return arrays(mechanism(), n=n)["time"]


def in_order(rows):
    return sorted(rows, key=lambda row: row[:3])


@pytest.mark.parametrize("memory", [1e9, 1000.0, 0.0])
def test_what_is_built_is_what_was_written(memory, budget):
    budget(memory)
    mech = mechanism()
    rows = in_order(CONTACTS)
    run = build(mech, contacts=rows).finish(times(), INFO)
    expected = arrays(mech, contacts=rows)
    assert set(run.arrays) == {*expected, *IMPACT}
    for key, array in expected.items():
        assert np.array_equal(run.arrays[key], array), key
    assert mapped(run.arrays["body_pose"]) == (memory < 1e9)


@pytest.mark.parametrize("memory", [1e9, 1000.0])
def test_going_on_leaves_alone_what_was_taken_out(memory, budget):
    """And puts other rows in place of the last ones."""
    budget(memory)
    builder = build(mechanism(), contacts=in_order(CONTACTS))
    run = builder.finish(times(), INFO, copied=True)
    pose, force = run.arrays["body_pose"].copy(), run.arrays["contact_force"].copy()
    builder.put(3, builder.blank(2))
    pair = np.ones((1, 2))
    builder.contacts.replace(2, np.array([4]), np.array([DISC]), np.array([DISTAL]), pair, pair,
                             pair, np.zeros(1), np.ones(1), np.zeros(1))
    assert np.array_equal(run.arrays["body_pose"], pose)
    assert np.array_equal(run.arrays["contact_force"], force)
    other = builder.finish(times(5), INFO)
    assert np.array_equal(other.arrays["body_pose"][:3], pose[:3])
    assert np.isnan(other.arrays["body_pose"][3:]).all()
    assert other.arrays["contact_sample"].tolist() == [1, 1, 4]


def test_files_live_as_long_as_the_recording_and_no_longer(tmp_path, budget):
    budget(0)
    mech = mechanism()
    run = build(mech).finish(times(), INFO)
    part = run.part(2, 5)
    del run
    gc.collect()
    assert mapped(part.arrays["body_pose"])
    assert np.array_equal(part.arrays["body_pose"], arrays(mech)["body_pose"][2:5])
    assert not list(tmp_path.iterdir())


def test_no_room_is_told_before_anything_runs(tmp_path, monkeypatch, budget):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.posix_fallocate", full, raising=False)
    budget(0)
    with pytest.raises(OutputError, match=r"no room for .* GB of samples in .*: No space left"):
        build(mechanism())
    budget(0, tmp_path / "missing")
    with pytest.raises(OutputError, match=r"no room for .*: No such file"):
        build(mechanism())


def test_a_run_beyond_its_budget_goes_to_files_as_it_comes(budget):
    """What is held does not grow with what is recorded: 8 MB of samples, 9 MB of contacts."""
    budget(1 << 20)
    mech, step, steps, rows = mechanism(), 500, 40, 5
    source = arrays(mech, n=1)
    tracemalloc.start()
    builder = RecordingBuilder(mech, step * steps, {key: source[key] for key in STATIC})
    body, pair = np.full(step * rows, DISTAL), np.ones((step * rows, 2))
    for k in range(steps):
        first = k * step
        builder.put(first, builder.blank(step))
        builder.contacts.replace(
            first, np.repeat(np.arange(first, first + step), rows), body, body + 1, pair, pair,
            pair, *(pair[:, 0],) * 3)
    run = builder.finish(np.arange(step * steps) / step, INFO)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert builder.recorded_bytes == sum(
        array.nbytes for key, array in run.arrays.items() if key not in STATIC)
    assert builder.recorded_bytes > 16e6
    assert peak < 4e6
    assert len(run) == step * steps
    for key in ("body_pose", "joint_force", "contact_force", "contact_sample"):
        assert mapped(run.arrays[key]), key
        assert not run.arrays[key].flags.writeable
    builder.finish(np.arange(step * steps) / step, INFO, copied=True)
    assert run.arrays["contact_sample"].tolist() == np.repeat(
        np.arange(step * steps), rows).tolist()
