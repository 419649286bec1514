"""Arrays as bytes that a browser unpacks: whole numbers, differences in time, zlib.

A block is ``n`` rows of ``k`` columns. A value is ``low + step * q`` with q from 0 to
``2^bits - 2``; the largest q, ``2^bits - 1``, means none. Of each column the differences of q from
row to row are kept, modulo ``2^bits``: first the low bytes of all columns, then the next ones. In
these planes what rests is zeros and what moves slowly has few high bytes.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from sandbox.elements.arrays import largest_size
from sandbox.numeric import Array, Flags
from sandbox.picture.listing import Listing, read_curve
from sandbox.samples.samples import Samples
from sandbox.web.drawing import expressions_of, moving, page_list

BUDGET = 3_300_000
"""Bytes of a run's numbers, before base64 makes them a third longer: 4.4 MB on a page."""
FRAMES = 4000  # samples that a drawing has, more or less; of a longer run some are left out
FINEST = 250.0  # samples per second [Hz] that are always kept
OFF = 2e-4
"""Maximum error of a pose between the samples that are kept, as a fraction of the picture's width:
a fifth of a pixel in 1000."""
BINS = 2000
"""Of a quantity with more than twice as many samples: the minimum and maximum of each bin. Fewer
where the numbers exceed the budget."""
LEVEL = 9
FLAT, NOTHING = 1e-9, 1e-10
"""Changes of a quantity below this fraction of its size, and values below this fraction of the
largest in its unit, are rounding errors."""


@dataclass
class Blocks:
    """Blocks of one sequence of bytes."""

    heads: list[dict[str, Any]] = field(default_factory=list)
    raw: bytearray = field(default_factory=bytearray)

    def add(self, key: str, columns: Array, *, bits: int = 16) -> None:
        """Append columns [k, n] under a name."""
        none = 2**bits - 1
        known = np.isfinite(columns)
        low = np.where(known, columns, np.inf).min(axis=1, initial=np.inf)
        high = np.where(known, columns, -np.inf).max(axis=1, initial=-np.inf)
        low, high = np.where(high >= low, (low, high), 0.0)
        low = np.array([float(f"{v:.10g}") for v in low])
        with np.errstate(over="ignore"):
            span = np.minimum(high - low, 1e308)
        step = np.where(span > 0, span / (none - 1), 1.0)
        whole = ((columns == np.rint(columns)) | ~known).all(axis=1)
        step = np.where(whole & (span < none - 1), 1.0, step)
        step = np.array([float(f"{v:.10g}") for v in step])
        with np.errstate(invalid="ignore", over="ignore"):
            q = np.rint((columns - low[:, None]) / step[:, None])
        q = np.where(known, np.clip(q, 0, none - 1), none).astype(np.uint32)
        self.heads.append({"key": key, "n": columns.shape[1], "k": columns.shape[0],
                           "at": len(self.raw), "bytes": bits // 8, "low": low.tolist(),
                           "step": step.tolist()})
        d = np.diff(q, axis=1, prepend=np.zeros((len(q), 1), q.dtype))
        for k in range(bits // 8):
            self.raw += (d >> np.uint32(8 * k)).astype(np.uint8).tobytes()


def kept_samples(time: Array, pose: Array, width: float) -> Flags:
    """The samples of a drawing, [n]: some, and all where interpolation exceeds :data:`OFF`.

    ``pose`` has x, y [m] and angle [rad] of each moving body in turn, [n, 3 k]; ``width`` is that
    of the picture [m].
    """
    n = len(time)
    every = -(-n // FRAMES)
    if n > 2:
        every = max(1, min(every, int(1 / (FINEST * max((time[-1] - time[0]) / (n - 1), 1e-12)))))
    kept = np.zeros(n, bool)
    kept[::every] = True
    kept[-1] = True
    if every == 1 or not pose.shape[1]:
        return kept
    at = np.flatnonzero(kept)
    # a turn shows at the rim of a body, which is about half a picture at most
    scale = np.tile([1.0, 1.0, width / 4], pose.shape[1] // 3) / (OFF * width)
    off = np.zeros(n, bool)
    for column in (pose * scale).T:
        off |= np.abs(np.interp(np.arange(n), at, column[at]) - column) > 1
    spans = np.logical_or.reduceat(off, at)
    return np.asarray(kept | np.repeat(spans, np.diff(at, append=n)))


class RunNumbers(NamedTuple):
    """A run's numbers."""

    parts: list[bytes]
    """Compressed: JSON with ``list``, ``blocks`` and ``series``; the drawing; the plots."""
    thinned: list[str]  # descriptions of the samples that are left out


def packed(run: Samples, out: Listing, names: list[str], width: float) -> RunNumbers:
    """Frames of a display list and quantities of a run; ``width`` of the picture [m]."""
    time, moves = run.time, moving(out)
    pose = out.pose[:, moves].reshape(len(time), -1)
    frames = np.flatnonzero(kept_samples(time, pose, width))
    blocks, said = Blocks(), []
    blocks.add("t", time[None, frames], bits=24)
    blocks.add("pose", np.ascontiguousarray(pose[frames].T))
    if out.columns:
        blocks.add("columns", np.array(out.columns)[:, frames])
    place = np.full(len(time), -1)
    place[frames] = np.arange(len(frames))
    for name, rows in out.tables.items():  # the rows in these samples, those of one key in a row
        rows = np.column_stack([place[rows[:, 0].astype(int)], rows[:, 1:]])
        rows = rows[rows[:, 0] >= 0]
        order = np.lexsort((rows[:, 0], rows[:, 1]))
        # samples are integers only as long as each has a step of its own
        blocks.add(f"table {name}", np.ascontiguousarray(rows[order].T),
                   bits=16 if len(frames) < 1 << 16 else 24)
    if len(frames) < len(time):
        said.append(f"drawing: {len(frames)} of {len(time)} samples, so that nothing is off by "
                    f"more than {1e3 * OFF * width:.2g} mm between them")
    series, values = _series(run, names)
    drawing = zlib.compress(bytes(blocks.raw), LEVEL)
    for bins in (BINS, BINS // 2, BINS // 4, BINS // 8, BINS // 16):
        plots = _plots(time, values, bins)
        heads = [{"part": part, **one} for part, some in enumerate((blocks, plots), 1)
                 for one in some.heads]
        head = json.dumps({**page_list(out), "blocks": heads, "series": series},
                          separators=(",", ":"), allow_nan=False)
        parts = [zlib.compress(head.encode(), LEVEL), drawing,
                 zlib.compress(bytes(plots.raw), LEVEL)]
        if sum(map(len, parts)) <= BUDGET:
            break
    if len(time) > 2 * bins:
        said.append(f"plots: the minimum and maximum of every {-(-len(time) // bins)} samples")
    return RunNumbers(parts, said)


def _series(run: Samples, names: list[str]) -> tuple[list[dict[str, Any]], Array]:
    """Quantities with name, unit and value ``v`` or column ``c``; the columns [k, n]."""
    worked = expressions_of(run.mechanism.view)
    found = {name: read_curve(run, name) for name in names}
    units = {name: worked[name] if name in worked else run.unit(name) for name in names}
    largest: dict[str, float] = {}
    for name, values in found.items():
        largest[units[name]] = max(largest.get(units[name], 0.0), largest_size(values))
    series, columns = list[dict[str, Any]](), list[Array]()
    for name, values in found.items():
        if np.isfinite(values).any():
            value = level(values, largest[units[name]])
            series.append({"name": name, "unit": units[name], **(
                {"c": len(columns)} if value is None else {"v": value})})
            columns += [values] if value is None else []
    return series, np.array(columns).reshape(len(columns), len(run))


def level(values: Array, largest: float) -> float | None:
    """The value of a quantity [n] that is constant apart from rounding; None of another.

    ``largest`` is the largest size of the run's quantities in this unit.
    """
    size = float(np.abs(values).max())
    if size <= NOTHING * largest:
        return 0.0
    return float(values[-1]) if np.ptp(values) <= FLAT * size else None  # nan is neither


def _plots(time: Array, values: Array, bins: int) -> Blocks:
    """Times and values for plots; of a long run the minimum and maximum of each bin, in order."""
    blocks = Blocks()
    n = len(time)
    if n > 2 * bins:
        per = -(-n // bins)
        starts = np.arange(0, n, per)
        # the last bin may be short: its last value again and again changes neither extreme
        padded = np.pad(values, ((0, 0), (0, len(starts) * per - n)), mode="edge")
        of = padded.reshape(len(values), len(starts), per)
        low, high = of.min(axis=2), of.max(axis=2)
        rising = of[..., -1] >= of[..., 0]
        values = np.stack((np.where(rising, low, high), np.where(rising, high, low)), axis=2)
        values = values.reshape(len(values), 2 * len(starts))
        ends = np.minimum(starts + per - 1, n - 1)
        time = np.stack((time[starts], np.maximum(time[ends], time[starts])), axis=1).ravel()
    blocks.add("ptime", time[None], bits=24)
    blocks.add("plots", values)
    return blocks


