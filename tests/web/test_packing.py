"""Numbers on their way to the browser: read back as the script reads them, thinned as said."""

import json
import zlib

import numpy as np
import pytest

from sandbox.picture.listing import Listing
from sandbox.recording.recording import Recording
from sandbox.web import packing
from sandbox.web.packing import OFF, Blocks, kept_samples, packed
from tests.draw.conftest import hand, zoo


def listing(run):
    """A display list of poses and contacts alone."""
    arrays = run.arrays
    out = Listing.of(run.time, arrays["body_pose"])
    key = arrays["contact_body"] * len(run.mechanism.bodies) + arrays["contact_other"]
    out.tables["contacts"] = np.column_stack([
        arrays["contact_sample"], key, arrays["contact_point"], arrays["contact_force"]])
    return out


def parts(numbers):
    """The head, and the bytes of the drawing and of the plots."""
    text, *others = map(zlib.decompress, numbers.parts)
    return json.loads(text), *others


def read(head, raw):
    """Columns [k, n] of a block, by the rule of packing.py and not by its code."""
    n, k, size = head["n"], head["k"], head["bytes"]
    planes = np.frombuffer(raw, np.uint8, n * k * size, head["at"]).reshape(size, k, n)
    q = sum(planes[i].astype(np.int64) << (8 * i) for i in range(size)).cumsum(axis=1)
    q %= 2 ** (8 * size)
    found = np.array(head["low"])[:, None] + np.array(head["step"])[:, None] * q
    return np.where(q == 2 ** (8 * size) - 1, np.nan, found)


@pytest.mark.parametrize("bits", [16, 24])
def test_values_come_back_within_half_a_step(bits):
    draw = np.random.default_rng(1)
    columns = np.vstack([draw.normal(size=500).cumsum(), 1e4 * draw.normal(size=500) + 3e6,
                         np.where(draw.random(500) < 0.2, np.nan, draw.random(500)),
                         np.full(500, 0.3), np.full(500, np.nan), np.arange(500.0) % 7])
    blocks = Blocks()
    blocks.add("first", columns[::-1].copy(), bits=bits)
    blocks.add("one", columns, bits=bits)
    found, head = read(blocks.heads[1], bytes(blocks.raw)), blocks.heads[1]
    assert np.array_equal(np.isnan(found), np.isnan(columns))
    span = np.nan_to_num(np.nanmax(np.nan_to_num(columns), axis=1)
                         - np.nanmin(np.nan_to_num(columns), axis=1))
    assert (np.array(head["step"]) <= np.maximum(span / (2**bits - 2) * (1 + 1e-8), 1.0)).all()
    # first value and step are kept with ten digits: half of 1e-9 of value and span besides
    within = 0.5 * np.array(head["step"]) + 1e-9 * np.nanmax(np.abs(np.nan_to_num(columns)), axis=1)
    assert (np.nan_to_num(np.abs(found - columns)) <= within[:, None]).all()
    assert np.array_equal(found[5], columns[5])  # whole numbers stay what they are


def test_the_samples_of_a_drawing_miss_no_pose():
    time = np.arange(20_000) * 1e-3
    x = np.where(time < 10, 0.1 * time, 1.0 + 0.02 * np.sin(300 * (time - 10)) * (time < 10.5))
    pose = np.column_stack([x, np.zeros_like(x), 3 * x])
    kept = kept_samples(time, pose, 0.5)
    assert kept[0]
    assert kept[-1]
    assert kept.sum() < 0.4 * len(time)
    assert np.diff(time[kept]).max() <= 1 / packing.FINEST + 1e-9
    at = time[kept]
    for column, share in ((0, 1.0), (2, 0.5 / 4)):
        missed = np.abs(np.interp(time, at, pose[kept, column]) - pose[:, column]) * share
        assert missed.max() <= OFF * 0.5 * (1 + 1e-9)


def test_plots_keep_the_least_and_the_greatest_of_each_bin(monkeypatch):
    run = hand(400)
    noise = np.random.default_rng(3).random((800, 1))
    run = type(run)(run.mechanism, {**run.arrays, "drive_value": noise}, run.info)
    monkeypatch.setattr(packing, "BINS", 100)
    found = packed(run, listing(run), ["actuator.value"], 0.6)
    assert len(found.thinned) == 1
    data, _, raw = parts(found)
    heads = {head["key"]: head for head in data["blocks"] if head["part"] == 2}
    values, times = read(heads["plots"], raw)[0], read(heads["ptime"], raw)[0]
    truth = run["actuator.value"]
    bins = [truth[i:i + 8] for i in range(0, 800, 8)]
    step = heads["plots"]["step"][0]
    assert np.abs(values.reshape(-1, 2).min(axis=1) - [b.min() for b in bins]).max() <= step
    assert np.abs(values.reshape(-1, 2).max(axis=1) - [b.max() for b in bins]).max() <= step
    assert (np.diff(times) >= 0).all()


def test_rows_of_tables_come_with_their_sample_and_their_key():
    run = hand()
    truth = listing(run).tables["contacts"]
    data, raw, _ = parts(packed(run, listing(run), [], 0.6))
    assert data["tables"] == {"contacts": 6}
    head = next(head for head in data["blocks"] if head["key"] == "table contacts")
    rows = read(head, raw).T
    truth = truth[np.lexsort((truth[:, 0], truth[:, 1]))]
    assert np.array_equal(rows[:, :2], truth[:, :2])
    assert np.abs(rows - truth).max() <= 0.5 * max(head["step"][2:]) + 1e-9


def test_a_budget_is_kept_and_said(monkeypatch):
    run = hand(2000)
    names = [name for name in run.names() if name.endswith((".x", ".y", ".angle", ".tension"))]
    whole = packed(run, listing(run), names, 0.6)
    most = sum(map(len, whole.parts))
    monkeypatch.setattr(packing, "BUDGET", most * 2 // 3)
    less = packed(run, listing(run), names, 0.6)
    assert sum(map(len, less.parts)) <= packing.BUDGET < most
    assert any(said.startswith("plots:") for said in less.thinned)


def with_meters(*meters):
    run = zoo()
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data |= {"meters": [{"name": name, "value": value, "unit": unit}
                        for name, value, unit in meters]}
    return Recording(type(run.mechanism).model_validate(data), run.arrays, run.info)


@pytest.mark.parametrize(("value", "unit", "told"), [
    ("=1e-16 * sin(9 * t)", "N", 0.0), ("=1e-11 * sin(9 * t)", "N", 0.0),
    ("=1e-6 * sin(9 * t)", "N", None), ("=10 + 1e-9 * sin(9 * t)", "N", 10.0),
    ("=10 + 1e-6 * sin(9 * t)", "N", None), ("=1e-16 * sin(9 * t)", "C", None)])
def test_what_rounding_leaves_is_constant(value, unit, told):
    """Of nothing else in its unit nobody knows that it is small."""
    run = with_meters(("one", value, unit), ("large", "=20 * t", "N"))
    data, *_ = parts(packed(run, listing(run), ["one", "large"], 1.0))
    series = {one["name"]: one for one in data["series"]}
    assert series["one"].get("v") == (told and pytest.approx(told))
    assert "c" in series["large"]
