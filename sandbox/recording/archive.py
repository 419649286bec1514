"""``run.npz``: writing and reading it; equal bytes for equal content.

A plain zip that ``numpy.load`` reads too: arrays in order of their names, without compression,
aligned so that they can be mapped, with a fixed date, then ``mechanism.json`` and ``info.json``;
the run's id is the archive's comment. No wall times. Reading checks names, sizes, shapes and types
before it unpacks anything; a large recording is mapped from its file.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import re
import struct
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from sandbox.elements.arrays import (
    ARRAYS,
    IMPACT,
    IN_ORDER,
    LARGEST,
    METERS,
    Arrays,
    Recorded,
    dtype_of,
    misshapen,
    sizes,
)
from sandbox.errors import OutputError, SceneError
from sandbox.numeric import Flags
from sandbox.samples.outcome import Outcome, outcome_data, read_outcome
from sandbox.samples.samples import Samples
from sandbox.scene.check.control import check_units
from sandbox.scene.check.ranges import check_ranges
from sandbox.scene.check.references import check_references
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits, check_limits, check_size
from sandbox.scene.read.scopes import resolved_tables
from sandbox.scene.read.source import parse_source
from sandbox.values.messages import explain
from sandbox.wording import quoted

FORMAT = 1
MECHANISM, INFO = "mechanism.json", "info.json"
IN_MEMORY = 1 << 26
"""Bytes of arrays up to which a recording is read into memory; larger ones are mapped."""
MAX_UNPACKED = 100_000_000  # Bytes that compressed members may have together
MAX_TEXT, MAX_INFO = 20_000_000, 1_000_000
"""Bytes of the mechanism's text, and of the description of the run."""
ANY = 10**18
LIMITS = Limits(problems=1, bodies=10_000, elements=100_000, values=1_000_000, steps=ANY,
                samples=ANY, recorded_bytes=ANY, frames=ANY)
"""Of a mechanism, far above the defaults for scenes."""
PIECE = 1 << 20  # Bytes that are read at a time
AT_ONCE = PIECE  # Bytes of whole rows of numbers that are checked at a time
ROUNDING = 1e-9
ALIGN, PADDING, SIZES = 64, "<HHH", 20
"""Alignment of arrays; zip's format of padding; bytes of sizes beyond 4 GB."""
RARE = ("events", "broke", "stopped", "controllers", "contact_solver")
"""Keys of ``info`` that are left out where they are empty."""
NAME = re.compile(r"\w{1,64}\.(npy|json)", re.ASCII)


def write(run: Samples, file: IO[bytes]) -> None:
    """Write the archive of a run into an open file."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        none = IMPACT if not len(run.arrays["impact_time"]) else ()
        for key, array in sorted(run.with_meters().items()):
            if key in none:
                continue
            entry, little = _member(f"{key}.npy"), array.dtype.newbyteorder("<")
            pad = -(file.tell() + 30 + len(entry.filename) + SIZES + struct.calcsize(PADDING)
                    ) % ALIGN  # so that the content begins at a multiple of 64 bytes
            entry.extra = struct.pack(PADDING, 0xD935, pad + 2, ALIGN) + bytes(pad)
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(
                    member, array.astype(little, order="C", copy=False), (1, 0))
        info = {key: value for key, value in outcome_data(run.info).items()
                if key != "wall_s" and (value or key not in RARE)}
        info |= {"format": FORMAT, "notes": run.notes}
        archive.writestr(_member(MECHANISM), run.mechanism.model_dump_json(by_alias=True))
        archive.writestr(_member(INFO), json.dumps(info, sort_keys=True, indent=1))
        members = [f"{one.filename} {one.file_size} {one.CRC:08x}\n" for one in archive.infolist()]
        archive.comment = hashlib.sha256("".join(members).encode()).hexdigest()[:32].encode()


def _member(name: str) -> zipfile.ZipInfo:
    """A zip entry that depends on nothing but its name."""
    info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    info.create_system, info.external_attr = 3, 0o644 << 16
    return info


class _Packed(NamedTuple):
    """An array in the archive."""

    kind: Recorded
    member: zipfile.ZipInfo
    shape: tuple[int, ...]
    header: int  # Bytes before its numbers


def read(path: Path) -> tuple[Mechanism, Arrays, Outcome, str]:
    """The mechanism, arrays, outcome and id of a recording; the id is empty in version 0.1.

    Raises:
        OutputError: missing, not an archive, damaged, of a newer format, or not of a run.
    """
    try:
        with path.open("rb") as file, zipfile.ZipFile(file) as archive:
            reading = _Reading(path, file, archive)
            info, mechanism = reading.info(), reading.mechanism()
            outcome = read_outcome(info, mechanism.run)
            return (mechanism, reading.arrays(mechanism), outcome,
                    archive.comment.decode("ascii", "replace"))
    except FileNotFoundError:
        raise OutputError(f"there is no recording in {path.parent}: {path.name} is missing",
                          code="no-run") from None
    except OSError as error:
        raise OutputError(f"cannot read {path}: {error.strerror or error}",
                          code="run-damaged") from None
    except OutputError:
        raise
    except ValueError as error:
        raise OutputError(f"{path} is damaged: {line_of(error)}", code="run-damaged") from None
    except Exception as error:  # zip, zlib, numpy and json each raise their own on garbage
        raise OutputError(f"{path} is not a recording, or damaged: {line_of(error)}",
                          code="run-damaged") from None


class _Reading:
    """One archive that is read; ValueError where it is damaged."""

    def __init__(self, path: Path, file: IO[bytes], archive: zipfile.ZipFile) -> None:
        self.path, self.file, self.archive = path, file, archive
        self.members = self._members()

    def _members(self) -> dict[str, zipfile.ZipInfo]:
        end, unpacked = self.file.seek(0, io.SEEK_END), 0
        found: dict[str, zipfile.ZipInfo] = {}
        for one in self.archive.infolist():
            name, stored = one.filename, one.compress_type == zipfile.ZIP_STORED
            if not NAME.fullmatch(name):
                raise ValueError(f"no part of a recording is called {quoted(name)}")
            if name in found:
                raise ValueError(f"{name!r} is in it twice")
            if one.flag_bits & 1 or not (stored or one.compress_type == zipfile.ZIP_DEFLATED):
                raise ValueError(f"{name!r} is encrypted, or packed in a way that is not read")
            if one.compress_size > end - one.header_offset or (
                    stored and one.file_size != one.compress_size):
                raise ValueError(f"{name!r} claims more bytes than there are")
            found[name] = one
            unpacked += 0 if stored else one.file_size
        if unpacked > MAX_UNPACKED:
            raise ValueError(
                f"its compressed parts would take {unpacked} bytes; allowed: at most "
                f"{MAX_UNPACKED}, or any size stored without compression")
        return found

    def _bytes(self, stream: IO[bytes], size: int) -> Iterator[bytes]:
        """So many bytes of a member, in pieces; an error if there are fewer."""
        while size:
            piece = stream.read(min(PIECE, size))
            if not piece:
                raise ValueError(f"{stream.name!r} ends too soon")
            size -= len(piece)
            yield piece

    def _text(self, name: str, most: int) -> str:
        if name not in self.members:
            raise ValueError(f"it has no {name!r}")
        size = self.members[name].file_size
        if size > most:
            raise ValueError(f"{name!r} has {size} bytes; allowed: at most {most}")
        with self.archive.open(self.members[name]) as stream:
            text = b"".join(self._bytes(stream, size)) + stream.read(1)
        return text.decode()

    def info(self) -> dict[str, Any]:
        """How the run ended."""
        try:
            info: Any = parse_source(self._text(INFO, MAX_INFO), limits=LIMITS).data
        except SceneError as error:
            raise ValueError(f"{INFO!r} cannot be read: {line_of(error.problems[0])}") from None
        version = info.pop("format", None) if isinstance(info, dict) else None
        if type(version) is not int or version < 1:
            raise ValueError(f"{INFO!r} does not describe a run")
        if version > FORMAT:
            raise OutputError(f"{self.path} has format {quoted(version)}; this version reads up to "
                              f"{FORMAT}: use a newer sandbox", code="unsupported-format")
        return dict(info)

    def mechanism(self) -> Mechanism:
        """Checked as a scene is, except for the length of the run."""
        text = self._text(MECHANISM, MAX_TEXT)
        data: Any = None
        try:
            data = parse_source(text, limits=LIMITS).data
            problems = check_size(data, LIMITS)
            if not problems:
                mechanism = Mechanism.model_validate(data, context={
                    "parameters": resolved_tables(data.get("tables"), {})})
                problems = check_limits(mechanism, LIMITS) or [
                    *check_units(mechanism), *check_references(mechanism),
                    *check_ranges(mechanism)]
        except SceneError as error:
            problems = error.problems
        except ValidationError as error:
            problems = explain(error, data, Mechanism)
        if problems:
            more = f", and {len(problems) - 1} more" if len(problems) > 1 else ""
            raise ValueError(f"its mechanism is not valid: {line_of(problems[0])}{more}")
        return mechanism

    def arrays(self, mechanism: Mechanism) -> Arrays:
        """The numbers, checked and kept in memory, or mapped where they are many."""
        places = {row.name: self._place(row, self.members[f"{row.name}.npy"])
                  for row in ARRAYS if f"{row.name}.npy" in self.members}
        if mechanism.meters and METERS not in places:
            raise ValueError(f"array {METERS!r} is missing")
        if found := misshapen(mechanism, {name: place.shape for name, place in places.items()}):
            raise ValueError("; ".join(found))
        size = sizes(mechanism, n=places["time"].shape[0])
        end = mechanism.run.duration + mechanism.run.step
        large = 8 * sum(math.prod(place.shape) for place in places.values()) > IN_MEMORY
        arrays = {name: self._array(place, size, end, mapped=large and math.prod(place.shape) > 0
                                    and place.member.compress_type == zipfile.ZIP_STORED)
                  for name, place in places.items()}
        for body, mass in zip(mechanism.bodies, arrays["body_mass"], strict=True):
            if body.motion == "dynamic" and np.isinf(mass):
                raise ValueError(f"array 'body_mass' has no weight for {quoted(body.name)}, "
                                 "which moves freely")
        return arrays

    def _place(self, row: Recorded, member: zipfile.ZipInfo) -> _Packed:
        with self.archive.open(member) as stream:
            try:
                if np.lib.format.read_magic(stream) != (1, 0):
                    raise ValueError
                shape, by_columns, given = np.lib.format.read_array_header_1_0(stream)
            except ValueError:
                raise ValueError(f"{member.filename!r} is not an array of numbers") from None
            header = stream.tell()
        wanted = np.dtype(dtype_of(row.name))
        if given != wanted.newbyteorder("<"):
            raise ValueError(f"array {row.name!r} holds {given}, expected {wanted}")
        if by_columns and len(shape) > 1:
            raise ValueError(f"array {row.name!r} is stored column by column")
        if min(shape, default=0) < 0 or header + 8 * math.prod(shape) != member.file_size:
            raise ValueError(f"array {row.name!r} of shape {shape} does not take the "
                             f"{member.file_size} bytes that it has")
        return _Packed(row, member, shape, header)

    def _array(
        self, place: _Packed, size: Mapping[str, int], end: float, *, mapped: bool,
    ) -> NDArray[Any]:
        kind, (count, *shape) = place.kind, place.shape
        dtype = np.dtype(dtype_of(kind.name)).newbyteorder("<")
        kept = np.empty((0 if mapped else count, *shape), dtype)
        row = dtype.itemsize * math.prod(shape)
        rows, last = max(1, AT_ONCE // max(row, 1)), None
        with self.archive.open(place.member) as stream:
            for _ in self._bytes(stream, place.header):
                pass
            for first in range(0, count, rows):
                number = min(rows, count - first)
                piece = b"".join(self._bytes(stream, number * row))
                values = np.frombuffer(piece, dtype).reshape(number, *shape)
                if bad := fault(kind, first, values, last, size, end):
                    raise ValueError(f"array {kind.name!r} {bad}")
                last = values[-1]
                if not mapped:
                    kept[first:first + number] = values
            stream.read(1)  # the checksum is compared where the member ends
        if not mapped:
            return kept
        self.file.seek(place.member.header_offset)
        name, extra = struct.unpack("<26xHH", self.file.read(30))
        offset = place.member.header_offset + 30 + name + extra + place.header
        return np.memmap(self.file, dtype, "r", offset, place.shape)


def fault(
    kind: Recorded, first: int, values: NDArray[Any], last: Any, size: Mapping[str, int],
    end: float,
) -> str:
    """The fault of rows of an array from number ``first`` on; empty if there is none.

    ``last`` is the row before them or None, ``size`` the lengths of all axes; no sample is later
    than ``end`` [s].
    """
    if kind.name == "time":
        back = ~(np.diff(values, prepend=-1.0 if last is None else last) > 0) | ~(values >= 0)
        beyond = values > end * (1 + ROUNDING)
        if (back | beyond).any():
            at = _first(back | beyond)
            what = f"{values[at]:.9g} s in sample {first + at}"
            return (f"goes on after the run's end of {end:.9g} s: {what}" if beyond[at]
                    else f"does not rise: {what}")
        return ""
    if kind.points:
        outside = (values < 0) | (values >= size[kind.points])
        if outside.any():
            at = _first(outside)
            return f"points outside 0..{size[kind.points] - 1} in row {first + at}: {values[at]}"
        back = np.diff(values, prepend=0 if last is None else last) < 0
        return (f"is not in order in row {first + _first(back)}"
                if kind.name in IN_ORDER and back.any() else "")
    bad = ~(np.abs(values) <= LARGEST)
    if kind.also == "inf":
        if (values <= 0).any():
            return "is not greater than 0"
        bad &= values != np.inf
    elif kind.also == "nan" or kind.late:
        bad &= ~np.isnan(values)
    if not bad.any():
        return ""
    row = {"once": "element", "sample": "sample", "mean": "sample", "meters": "sample"}.get(
        kind.when, "row")
    return f"holds {values[bad][0]:.6g} in {row} {first + _first(bad)}"


def _first(bad: Flags) -> int:
    """The first bad row."""
    return int(np.argmax(bad.reshape(len(bad), -1).any(axis=1)))


def line_of(error: object) -> str:
    """The first line of an error's text, at most 200 characters."""
    return (str(error).splitlines() or [type(error).__name__])[0][:200]
