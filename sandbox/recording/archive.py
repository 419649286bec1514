"""``run.npz``: writing and reading it; equal bytes for equal content.

A plain zip that ``numpy.load`` reads too: arrays in order of their names, without compression,
aligned so that they can be mapped, with a fixed date, then ``mechanism.json`` and ``info.json``;
the run's id is the archive's comment. No wall times.

Reading unpacks nothing before its names, sizes, shapes and types are checked: first the members,
then the texts, then the headers of the arrays, last their numbers, in pieces. A large recording is
mapped from its file, not read into memory.
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
from sandbox.scene.read.source import half_character, parse_source
from sandbox.values.messages import explain
from sandbox.wording import quoted

FORMAT = 1
MECHANISM, INFO = "mechanism.json", "info.json"
IN_MEMORY = 1 << 26
"""Bytes of arrays up to which a recording is read into memory; larger ones are mapped."""
MOST_UNPACKED = 100_000_000
"""Bytes that compressed members may have together."""
MOST_TEXT, MOST_INFO = 20_000_000, 1_000_000
"""Bytes of the mechanism's text, and of the description of the run."""
ANY = 10**18
LIMITS = Limits(problems=1, bodies=10_000, elements=100_000, values=1_000_000, steps=ANY,
                samples=ANY, recorded_bytes=ANY, frames=ANY)
"""Of a mechanism, far above the defaults for scenes."""
PIECE = 1 << 20
"""Bytes that are read at a time; the archive's directory has to be within it."""
AT_ONCE = PIECE
"""Bytes of whole rows of numbers that are checked at a time."""
ROUNDING = 1e-9
ALIGN, PADDING, SIZES = 64, "<HHH", 20
"""Alignment of arrays; zip's format of padding; bytes of sizes beyond 4 GB."""
RARE = ("events", "broke", "stopped", "controllers", "contact_solver")
"""Keys of ``info`` that are left out where they are empty."""
NAME = re.compile(r"\w{1,64}\.(npy|json)", re.ASCII)
HEADER = re.compile(rb"\{'descr': '([<>|=]?[a-zA-Z][0-9]{1,4})', 'fortran_order': (True|False), "
                    rb"'shape': \(((?:[0-9]{1,18}(?:, ?|,?(?=\))))*)\),? *\} *\n")


def write(run: Samples, file: IO[bytes]) -> None:
    """Write the archive of a run into an open file.

    Raises:
        OSError: the disk is full, or gone.
    """
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
        members = [f"{one.filename} {one.file_size} {one.CRC:08x}\n"
                   for one in archive.infolist()]
        archive.comment = hashlib.sha256("".join(members).encode()).hexdigest()[:32].encode()


def read_id(path: Path) -> str:
    """The id of the run in an archive; empty in version 0.1.

    Raises:
        OutputError: there is no archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.comment.decode("ascii", "replace")
    except (OSError, zipfile.BadZipFile) as error:
        raise OutputError(f"cannot read {path}: {line_of(error)}", code="run-damaged") from None


def _member(name: str) -> zipfile.ZipInfo:
    """A zip entry that depends on nothing but its name."""
    info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    info.create_system, info.external_attr = 3, 0o644 << 16
    return info


class _Pieces(io.FileIO):
    """A file of which at most a piece is read at a time, whatever size its directory claims."""

    def read(self, size: int | None = -1) -> bytes:
        """So many bytes, all that are left if negative.

        Raises:
            ValueError: more than a piece.
        """
        if size is None or size < 0:
            here = self.tell()
            size = self.seek(0, io.SEEK_END) - here
            self.seek(here)
        if size > PIECE:
            raise ValueError(f"its directory claims {size} bytes")
        return super().read(size) or b""


class _Packed(NamedTuple):
    """An array in the archive."""

    kind: Recorded
    member: zipfile.ZipInfo
    shape: tuple[int, ...]
    header: int
    """Bytes before its numbers."""

    @property
    def bytes(self) -> int:
        """Bytes of its numbers."""
        return math.prod(self.shape) * 8


def read(path: Path) -> tuple[Mechanism, Arrays, Outcome, str]:
    """The mechanism, arrays, outcome and id of a recording; the id is empty in version 0.1.

    Raises:
        OutputError: missing, not an archive, damaged, of a newer format, or not of a run.
    """
    try:
        with _Pieces(path) as file, zipfile.ZipFile(file) as archive:
            return _Reading(path, file, archive).whole()
    except FileNotFoundError:
        raise OutputError(f"there is no recording in {path.parent}: {path.name} is missing",
                          code="no-run") from None
    except OSError as error:
        raise OutputError(f"cannot read {path}: {error.strerror or error}",
                          code="run-damaged") from None
    except OutputError:
        raise
    except Exception as error:  # zip, zlib, numpy and json each raise their own on garbage
        raise OutputError(f"{path} is not a recording, or damaged: {line_of(error)}",
                          code="run-damaged") from None


class _Reading:
    """One archive that is read."""

    def __init__(self, path: Path, file: _Pieces, archive: zipfile.ZipFile) -> None:
        self.path, self.file, self.archive = path, file, archive
        self.members = self._members()

    def damaged(self, what: str) -> OutputError:
        """The error that names a fault of the file."""
        return OutputError(f"{self.path} is damaged: {what}", code="run-damaged")

    def whole(self) -> tuple[Mechanism, Arrays, Outcome, str]:
        """Everything, in the order of the module's text."""
        if lacking := sorted({MECHANISM, INFO} - self.members.keys()):
            raise OutputError(f"{self.path} is not a recording: it has no {lacking[0]!r}",
                              code="run-damaged")
        info = self._info()
        mechanism = self._mechanism()
        try:
            outcome = read_outcome(info, mechanism.run)
        except ValueError as error:
            raise self.damaged(f"{INFO!r} does not describe a run: {error}") from None
        return (mechanism, self._arrays(mechanism), outcome,
                self.archive.comment.decode("ascii", "replace"))

    def _members(self) -> dict[str, zipfile.ZipInfo]:
        end, unpacked = self.file.seek(0, io.SEEK_END), 0
        found: dict[str, zipfile.ZipInfo] = {}
        for one in self.archive.infolist():
            name, stored = one.filename, one.compress_type == zipfile.ZIP_STORED
            if not NAME.fullmatch(name):
                raise self.damaged(f"no part of a recording is called {quoted(name)}")
            if name in found:
                raise self.damaged(f"{name!r} is in it twice")
            if one.flag_bits & 1 or not (stored or one.compress_type == zipfile.ZIP_DEFLATED):
                raise self.damaged(f"{name!r} is encrypted, or packed in a way that is not read")
            if one.compress_size > end - one.header_offset or (
                    stored and one.file_size != one.compress_size):
                raise self.damaged(f"{name!r} claims more bytes than there are")
            found[name] = one
            unpacked += 0 if stored else one.file_size
        if unpacked > MOST_UNPACKED:
            raise self.damaged(
                f"its compressed parts would take {unpacked} bytes; allowed: at most "
                f"{MOST_UNPACKED}, or any size stored without compression")
        return found

    def _bytes(self, stream: IO[bytes], size: int) -> Iterator[bytes]:
        """So many bytes of a member, in pieces.

        Raises:
            OutputError: there are less.
        """
        while size:
            piece = stream.read(min(PIECE, size))
            if not piece:
                raise self.damaged(f"{stream.name!r} ends too soon")
            size -= len(piece)
            yield piece

    # -- texts ------------------------------------------------------------------------

    def _text(self, name: str, most: int) -> str:
        size = self.members[name].file_size
        if size > most:
            raise self.damaged(f"{name!r} has {size} bytes; allowed: at most {most}")
        with self.archive.open(self.members[name]) as stream:
            text = b"".join(self._bytes(stream, size)) + stream.read(1)
        return text.decode()

    def _info(self) -> dict[str, Any]:
        try:
            info: Any = json.loads(self._text(INFO, MOST_INFO))
            deep = _deeper(info, LIMITS.nesting)
            half = "" if deep else half_character(json.dumps(info, ensure_ascii=False))
        except (ValueError, RecursionError) as error:
            raise self.damaged(f"{INFO!r} cannot be read: {line_of(error)}") from None
        if half:
            raise self.damaged(f"{INFO!r} cannot be read: {half}")
        version = info.pop("format", None) if isinstance(info, dict) else None
        if type(version) is not int or version < 1 or deep:
            raise self.damaged(f"{INFO!r} does not describe a run")
        if version > FORMAT:
            raise OutputError(f"{self.path} has format {quoted(version)}; this version reads up to "
                              f"{FORMAT}: use a newer sandbox", code="unsupported-format")
        return dict(info)

    def _mechanism(self) -> Mechanism:
        """Checked as a scene is, except for the length of the run."""
        text = self._text(MECHANISM, MOST_TEXT)
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
            raise self.damaged(f"its mechanism is not valid: {line_of(problems[0])}{more}")
        return mechanism

    # -- arrays -----------------------------------------------------------------------

    def _arrays(self, mechanism: Mechanism) -> Arrays:
        """The numbers, checked and kept in memory, or mapped where they are many."""
        places = {row.name: self._place(row, self.members[f"{row.name}.npy"])
                  for row in ARRAYS if f"{row.name}.npy" in self.members}
        if mechanism.meters and METERS not in places:
            raise self.damaged(f"array {METERS!r} is missing")
        if found := misshapen(mechanism, {name: place.shape for name, place in places.items()}):
            raise self.damaged("; ".join(found))
        size = sizes(mechanism, samples=places["time"].shape[0])
        end = mechanism.run.duration + mechanism.run.step
        mapped = sum(place.bytes for place in places.values()) > IN_MEMORY
        arrays = {name: self._array(place, size, end, mapped=mapped and place.bytes > 0
                                    and place.member.compress_type == zipfile.ZIP_STORED)
                  for name, place in places.items()}
        for body, mass in zip(mechanism.bodies, arrays["body_mass"], strict=True):
            if body.motion == "dynamic" and np.isinf(mass):
                raise self.damaged(f"array 'body_mass' has no weight for {quoted(body.name)}, "
                                   "which moves freely")
        return arrays

    def _place(self, row: Recorded, member: zipfile.ZipInfo) -> _Packed:
        with self.archive.open(member) as stream:
            begins = stream.read(10)
            length = int.from_bytes(begins[8:10], "little")
            header = HEADER.fullmatch(stream.read(length))
        if begins[:8] != b"\x93NUMPY\x01\x00" or header is None:
            raise self.damaged(f"{member.filename!r} is not an array of numbers")
        given, wanted = np.dtype(header[1].decode()), np.dtype(dtype_of(row.name))
        if given != wanted.newbyteorder("<"):
            raise self.damaged(f"array {row.name!r} holds {given}, expected {wanted}")
        shape = tuple(int(part) for part in header[3].replace(b",", b" ").split())
        if header[2] == b"True" and len(shape) > 1:
            raise self.damaged(f"array {row.name!r} is stored column by column")
        place = _Packed(row, member, shape, 10 + length)
        if place.header + place.bytes != member.file_size:
            raise self.damaged(f"array {row.name!r} of shape {shape} does not take the "
                               f"{member.file_size} bytes that it has")
        return place

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
                if wrong := fault(kind, first, values, last, size, end):
                    raise self.damaged(f"array {kind.name!r} {wrong}")
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
    """What is wrong with some rows of an array; empty if nothing is.

    Args:
        kind: of the array.
        first: number of the first row.
        values: the rows.
        last: the row before them, or None.
        size: the lengths of all axes, which numbers of elements refer to.
        end: no sample is later [s].
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
    wrong = ~(np.abs(values) <= LARGEST)
    if kind.also == "inf":
        if (values <= 0).any():
            return "is not greater than 0"
        wrong &= values != np.inf
    elif kind.also == "nan" or kind.late:
        wrong &= ~np.isnan(values)
    if not wrong.any():
        return ""
    row = {"once": "element", "sample": "sample", "mean": "sample", "meters": "sample"}.get(
        kind.when, "row")
    return f"holds {values[wrong][0]:.6g} in {row} {first + _first(wrong)}"


def _first(wrong: Flags) -> int:
    """The first row in which something is wrong."""
    return int(np.argmax(wrong.reshape(len(wrong), -1).any(axis=1)))


def _deeper(data: Any, levels: int) -> bool:
    """Whether data nest deeper than so many levels."""
    layer = [data]
    for _ in range(levels):
        layer = [each for one in layer if isinstance(one, (dict, list))
                 for each in (one.values() if isinstance(one, dict) else one)]
    return bool(layer)


def line_of(error: object) -> str:
    """The first line of an error's text, at most 200 characters."""
    return (str(error).splitlines() or [type(error).__name__])[0][:200]
