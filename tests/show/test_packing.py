"""Numbers on their way to the browser: read back as the script reads them, thinned as said."""

import zlib

import numpy as np
import pytest

from sandbox.elements.arrays import CONTACT, PER_SAMPLE
from sandbox.recording.recording import Recording
from sandbox.show import packing
from sandbox.show.packing import OFF, Blocks, kept_samples, packed
from tests.draw.conftest import hand, zoo
from tests.draw.test_unions import box_on_floor


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
    run = hand(samples=801)
    noise = np.random.default_rng(3).random((801, len(run.mechanism.tendons)))
    run = type(run)(run.mechanism, {**run.arrays, "tendon_tension": noise}, run.info)
    monkeypatch.setattr(packing, "BINS", 100)
    found = packed(run, ["tree.actuator.tension"], 0.6, None)
    assert len(found.thinned) == 1
    raw = zlib.decompress(found.data[found.sizes[0]:])
    heads = {head["key"]: head for head in found.blocks if head["part"] == 1}
    values, times = read(heads["plots"], raw)[0], read(heads["ptime"], raw)[0]
    truth = run["tree.actuator.tension"]
    bins = [truth[i:i + 9] for i in range(0, 801, 9)]
    step = heads["plots"]["step"][0]
    assert np.abs(values.reshape(-1, 2).min(axis=1) - [b.min() for b in bins]).max() <= step
    assert np.abs(values.reshape(-1, 2).max(axis=1) - [b.max() for b in bins]).max() <= step
    assert (np.diff(times) >= 0).all()


def test_contact_forces_come_with_their_sample_on_the_body_that_they_are_shown_on():
    run = hand()
    found = packed(run, [], 0.6, None)
    raw = zlib.decompress(found.data[:found.sizes[0]])
    head = next(head for head in found.blocks if head["key"] == "contact")
    rows = read(head, raw).T
    names = [body.name for body in run.mechanism.bodies]
    assert all(names[int(row[4])].startswith("section") for row in rows)
    rows = rows[np.lexsort((rows[:, 5], rows[:, 6]))]
    # recorded on the phalanges; what a finger feels the object feels the other way round
    a = run.arrays
    order = np.lexsort((a["contact_body"], a["contact_sample"]))
    truth = np.column_stack([a["contact_point"], -a["contact_force"], a["contact_other"],
                             a["contact_body"], a["contact_sample"]])[order]
    assert np.abs(rows - truth).max() <= 0.5 * max(head["step"][:4]) + 1e-9
    assert np.array_equal(rows[:, 4:], truth[:, 4:])


@pytest.mark.parametrize(("run", "key"), [(hand(fingers=1, samples=2), "contact"),
                                          (box_on_floor(0.05), "patch")])
def test_rows_of_more_samples_than_16_bits_count_keep_the_numbers_of_theirs(run, key):
    n = 70_000
    arrays = {**run.arrays, **{name: np.repeat(run.arrays[name][:1], n, axis=0)
                               for name in PER_SAMPLE}, "time": np.arange(n) / 250}
    kept = np.arange(0, n, 7)
    arrays |= {name: np.repeat(run.arrays[name][:1], len(kept), axis=0) for name in CONTACT}
    arrays["contact_sample"] = kept
    long = type(run)(run.mechanism, arrays, run.info)
    found = packed(long, [], 0.6, None)
    head = next(head for head in found.blocks if head["key"] == key)
    rows = read(head, zlib.decompress(found.data[:found.sizes[0]]))
    assert np.array_equal(rows[6], kept)


def test_a_budget_is_kept_and_said(monkeypatch):
    run = hand(samples=6001)
    names = [name for name in run.names() if name.endswith((".x", ".y", ".angle", ".tension"))]
    whole = packed(run, names, 0.6, None)
    monkeypatch.setattr(packing, "BUDGET", len(whole.data) * 2 // 3)
    less = packed(run, names, 0.6, None)
    assert len(less.data) <= packing.BUDGET < len(whole.data)
    assert any(said.startswith("plots:") for said in less.thinned)


def test_sides_that_touch_come_with_their_pressure_and_the_way_out_of_the_body():
    numbers = packed(box_on_floor(0.05), [], 1.0, None)
    head = next(one for one in numbers.blocks if one["key"] == "patch")
    raw = zlib.decompress(numbers.data[:numbers.sizes[0]])
    (x0, y0, q0, x1, y1, q1, sample), = read(head, raw).T
    # a triangle up to the box's edge; down is out of the box, to the left of the way from x0 to x1
    assert (x0, q0, x1, q1) == pytest.approx((0.5, 2 * 9.81 / 0.15, 0.35, 0.0), rel=1e-3, abs=1e-6)
    assert (y0, y1, sample) == (0, 0, 0)


def with_meters(*meters, view=()):
    run = zoo()
    data = run.mechanism.model_dump(mode="json", by_alias=True)
    data |= {"meters": [{"name": name, "value": value, "unit": unit}
                        for name, value, unit in meters]}
    data["view"] = {**(data["view"] or {}), "meters": list(view)}
    return Recording(type(run.mechanism).model_validate(data), run.arrays, run.info)


@pytest.mark.parametrize(("value", "unit", "told"), [
    ("=1e-16 * sin(9 * t)", "N", 0.0), ("=1e-11 * sin(9 * t)", "N", 0.0),
    ("=1e-6 * sin(9 * t)", "N", None), ("=10 + 1e-9 * sin(9 * t)", "N", 10.0),
    ("=10 + 1e-6 * sin(9 * t)", "N", None), ("=1e-16 * sin(9 * t)", "C", None)])
def test_what_rounding_leaves_is_constant(value, unit, told):
    """Of nothing else in its unit nobody knows that it is small."""
    run = with_meters(("one", value, unit), ("large", "=20 * t", "N"))
    series = {one["name"]: one for one in packed(run, ["one", "large"], 1.0, None).series}
    assert series["one"].get("v") == (told and pytest.approx(told))
    assert "c" in series["large"]


def test_curves_of_the_views_meters_are_quantities_of_the_page():
    run = with_meters(("large", "=20 * t", "N"), view=[{"of": "=large / 2 - t", "unit": "kN"}])
    numbers = packed(run, ["=large / 2 - t"], 1.0, None)
    assert numbers.series == [{"name": "=large / 2 - t", "unit": "kN", "c": 0}]
    head = next(one for one in numbers.blocks if one["key"] == "plots")
    raw = zlib.decompress(numbers.data[numbers.sizes[0]:])
    assert read(head, raw)[0] == pytest.approx(9 * run.time, abs=1e-5)
