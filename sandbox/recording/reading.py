"""Reading ``run.npz``, whoever wrote it: nothing is unpacked before it is known what it is.

First the members: their names, their sizes against the file's. Then ``info.json`` and
``mechanism.json``, which is held to what a scene is held to. Then the headers of the arrays,
whose shapes and types follow from the mechanism and two numbers. Only then the numbers, in
pieces: time goes forward, rows point at what is there, what has to be a number is one.

A large recording is not read into memory but mapped from its file, where arrays are stored as
they are.
"""

from __future__ import annotations

import io
import json
import math
import re
import struct
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from sandbox.elements.arrays import (
    ARRAYS,
    IN_ORDER,
    LARGEST,
    METERS,
    Arrays,
    Recorded,
    dtype_of,
    misshapen,
    sizes,
)
from sandbox.errors import OutputError, Problem, SceneError
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.outcome import Outcome, read_outcome
from sandbox.scene.check.control import check_units
from sandbox.scene.check.ranges import check_ranges
from sandbox.scene.check.references import check_references
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits, check_limits, check_lists, check_values
from sandbox.scene.read.positions import half_character
from sandbox.scene.read.scopes import resolved_tables
from sandbox.scene.read.source import parse_source
from sandbox.values.numbers import message_of
from sandbox.wording import quoted

FORMAT = 1
MECHANISM, INFO = "mechanism.json", "info.json"
IN_MEMORY = 1 << 26
"""Bytes of arrays up to which a recording is read into memory; larger ones are mapped."""
MOST_UNPACKED = 100_000_000
"""Bytes that compressed members may have together."""
MOST_TEXT, MOST_INFO = 20_000_000, 1_000_000
"""Bytes of the mechanism's text, and of what is said of the run."""
ANY = 10**18
LIMITS = Limits(problems=1, bodies=10_000, elements=100_000, values=1_000_000, steps=ANY,
                samples=ANY, recorded_bytes=ANY, frames=ANY)
"""Of a mechanism, far above what scenes may have by default; its run has been made already."""
PIECE = 1 << 20
"""Bytes that are read at a time; the archive's directory has to be within it."""
AT_ONCE = PIECE
"""Bytes of whole rows of numbers that are looked at at a time."""
NAME = re.compile(r"\w{1,64}\.(npy|json)", re.ASCII)
HEADER = re.compile(rb"\{'descr': '([<>|=]?[a-zA-Z][0-9]{1,4})', 'fortran_order': (True|False), "
                    rb"'shape': \(((?:[0-9]{1,18}(?:, ?|,?(?=\))))*)\),? *\} *\n")


class Read(NamedTuple):
    """What a recording is made of."""

    mechanism: Mechanism
    arrays: Arrays
    outcome: Outcome
    run_id: str
    """Empty for a recording of an older version."""


class _Pieces(io.FileIO):
    """A file of which a piece is read at a time: what it claims of itself takes no memory."""

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
        """That its numbers take."""
        return math.prod(self.shape) * 8


def read(path: Path) -> Read:
    """What a recording is made of.

    Raises:
        OutputError: missing, not an archive, damaged, of a newer format, or what no run is.
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
        raise OutputError(f"{path} is not a recording, or damaged: {_line(error)}",
                          code="run-damaged") from None


class _Reading:
    """One archive on its way in."""

    def __init__(self, path: Path, file: _Pieces, archive: zipfile.ZipFile) -> None:
        self.path, self.file, self.archive = path, file, archive
        self.members = self._members()

    def damaged(self, what: str) -> OutputError:
        """The error that says what is wrong with the file."""
        return OutputError(f"{self.path} is damaged: {what}", code="run-damaged")

    def whole(self) -> Read:
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
        places = self._places(mechanism)
        return Read(mechanism, self._arrays(mechanism, places), outcome,
                    self.archive.comment.decode("ascii", "replace"))

    # -- members ----------------------------------------------------------------------

    def _members(self) -> dict[str, zipfile.ZipInfo]:
        end = self.file.seek(0, io.SEEK_END)
        found: dict[str, zipfile.ZipInfo] = {}
        unpacked = 0
        for one in self.archive.infolist():
            name = one.filename
            if not NAME.fullmatch(name):
                raise self.damaged(f"no part of a recording is called {quoted(name)}")
            if name in found:
                raise self.damaged(f"{name!r} is in it twice")
            found[name] = one
            stored = one.compress_type == zipfile.ZIP_STORED
            if one.flag_bits & 1 or not (stored or one.compress_type == zipfile.ZIP_DEFLATED):
                raise self.damaged(f"{name!r} is encrypted, or packed in a way that is not read")
            if one.compress_size > end - one.header_offset or (
                    stored and one.file_size != one.compress_size):
                raise self.damaged(f"{name!r} claims more bytes than there are")
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

    def _text(self, name: str, most: int) -> str:
        size = self.members[name].file_size
        if size > most:
            raise self.damaged(f"{name!r} has {size} bytes; allowed: at most {most}")
        with self.archive.open(self.members[name]) as stream:
            text = b"".join(self._bytes(stream, size)) + stream.read(1)
        return text.decode()

    # -- texts ------------------------------------------------------------------------

    def _info(self) -> dict[str, Any]:
        try:
            info: Any = json.loads(self._text(INFO, MOST_INFO))
            deep = _deeper(info, LIMITS.nesting)
            half = "" if deep else half_character(json.dumps(info, ensure_ascii=False))
        except (ValueError, RecursionError) as error:
            raise self.damaged(f"{INFO!r} cannot be read: {_line(error)}") from None
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
        """Held to what a scene is held to, but for the length of the run, which is on the disk."""
        text = self._text(MECHANISM, MOST_TEXT)
        try:
            data = parse_source(text, limits=LIMITS).data
            if not isinstance(data, dict):
                raise SceneError([Problem("wrong-type", "it is no object", "$")])
            if problems := [*check_lists(data, LIMITS), *check_values(data, LIMITS)]:
                raise SceneError(problems)
            mechanism = Mechanism.model_validate(data, context={
                "parameters": resolved_tables(data.get("tables"), {})})
            if problems := check_limits(mechanism, LIMITS):
                raise SceneError(problems)
            problems = [*check_units(mechanism), *check_references(mechanism),
                        *check_ranges(mechanism)]
        except SceneError as error:
            problems = error.problems
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            where = ".".join(str(step) for step in first["loc"])
            raise self.damaged("its mechanism is not valid: "
                               f"{quoted(where)[1:-1]}: {_line_of(message_of(first))}") from None
        if problems:
            more = f", and {len(problems) - 1} more" if len(problems) > 1 else ""
            raise self.damaged(f"its mechanism is not valid: {_line_of(str(problems[0]))}{more}")
        return mechanism

    # -- arrays -----------------------------------------------------------------------

    def _places(self, mechanism: Mechanism) -> list[_Packed]:
        """Where the arrays are, all of the shapes and types that belong to the mechanism."""
        places = {row.name: self._place(row, self.members[f"{row.name}.npy"])
                  for row in ARRAYS if f"{row.name}.npy" in self.members}
        if mechanism.meters and METERS not in places:
            raise self.damaged(f"array {METERS!r} is missing")
        if found := misshapen(mechanism, {name: place.shape for name, place in places.items()}):
            raise self.damaged("; ".join(found))
        return list(places.values())

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

    def _arrays(self, mechanism: Mechanism, places: list[_Packed]) -> Arrays:
        """The numbers, looked at on the way and kept in memory, or mapped where they are many."""
        shapes = {place.kind.name: place.shape for place in places}
        span = Span(sizes(mechanism, samples=shapes["time"][0]),
                    mechanism.run.duration + mechanism.run.step)
        mapped = sum(place.bytes for place in places) > IN_MEMORY
        arrays = {place.kind.name: self._array(place, span, mapped=mapped and place.bytes > 0
                                               and place.member.compress_type == zipfile.ZIP_STORED)
                  for place in places}
        for body, mass in zip(mechanism.bodies, arrays["body_mass"], strict=True):
            if body.motion == "dynamic" and np.isinf(mass):
                raise self.damaged(f"array 'body_mass' has no weight for {quoted(body.name)}, "
                                   "which moves freely")
        return arrays

    def _array(self, place: _Packed, span: Span, *, mapped: bool) -> NDArray[Any]:
        dtype = np.dtype(dtype_of(place.kind.name)).newbyteorder("<")
        kept = np.empty((0 if mapped else place.shape[0], *place.shape[1:]), dtype)
        row = dtype.itemsize * math.prod(place.shape[1:])
        rows = max(1, AT_ONCE // max(row, 1))
        check = checks(place.kind, span)
        with self.archive.open(place.member) as stream:
            for _ in self._bytes(stream, place.header):
                pass
            for first in range(0, place.shape[0], rows):
                count = min(rows, place.shape[0] - first)
                piece = b"".join(self._bytes(stream, count * row))
                values = np.frombuffer(piece, dtype).reshape(count, *place.shape[1:])
                if wrong := check(first, values):
                    raise self.damaged(f"array {place.kind.name!r} {wrong}")
                if not mapped:
                    kept[first:first + count] = values
            stream.read(1)  # the checksum is compared where the member ends
        return self._mapped(place, dtype) if mapped else kept

    def _mapped(self, place: _Packed, dtype: np.dtype[Any]) -> NDArray[Any]:
        """An array where it lies in the file, which has to stay as it is meanwhile."""
        self.file.seek(place.member.header_offset)
        name, extra = struct.unpack("<26xHH", self.file.read(30))
        offset = place.member.header_offset + 30 + name + extra + place.header
        return np.memmap(self.file, dtype, "r", offset, place.shape)


def _deeper(data: Any, levels: int) -> bool:
    """Whether data nest deeper than so many levels."""
    layer = [data]
    for _ in range(levels):
        layer = [each for one in layer if isinstance(one, (dict, list))
                 for each in (one.values() if isinstance(one, dict) else one)]
        if not layer:
            return False
    return True


def _line(error: BaseException) -> str:
    return _line_of(str(error) or type(error).__name__)


def _line_of(text: str) -> str:
    return (text.splitlines() or [""])[0][:200]


Check = Callable[[int, NDArray[Any]], str]
"""Of the number of the first row of a piece and the piece: what is wrong with it, or nothing."""
ROUNDING = 1e-9


@dataclass(frozen=True)
class Span:
    """What the numbers of a recording refer to."""

    sizes: Mapping[str, int]
    """How many there are along every axis."""
    end: float
    """No sample is later [s]."""


def checks(kind: Recorded, span: Span) -> Check:
    """What to look for in an array; its pieces come in order, from the first row on."""
    if kind.name == "time":
        return _Rising(span.end)
    if kind.points:
        return _Pointing(span.sizes[kind.points], ordered=kind.name in IN_ORDER)
    row = {"once": "element", "sample": "sample", "mean": "sample", "meters": "sample"}.get(
        kind.when, "row")

    def numbers(first: int, values: Array) -> str:
        wrong = ~(np.abs(values) <= LARGEST)
        if kind.also == "inf":
            if (values <= 0).any():
                return "is not greater than 0"
            wrong &= values != np.inf
        elif kind.also == "nan" or kind.late:
            wrong &= ~np.isnan(values)
        if not wrong.any():
            return ""
        at = _first(wrong)
        return f"holds {values[wrong][0]:.6g} in {row} {first + at}"

    return numbers


class _Rising:
    """Time goes forward, from 0 to the run's end."""

    def __init__(self, end: float) -> None:
        self._last, self._end = 0.0, end

    def __call__(self, first: int, values: Array) -> str:
        before = np.concatenate([[self._last], values[:-1]])
        ahead = values > before
        if first == 0:
            ahead[:1] = values[:1] >= 0
        beyond = values > self._end * (1 + ROUNDING)
        if not ahead.all() or beyond.any():
            at = _first(~ahead | beyond)
            what = f"{values[at]:.9g} s in sample {first + at}"
            return (f"goes on after the run's end of {self._end:.9g} s: {what}" if beyond[at]
                    else f"does not rise: {what}")
        self._last = float(values[-1])
        return ""


class _Pointing:
    """Numbers of rows or elements that are there."""

    def __init__(self, count: int, *, ordered: bool) -> None:
        self._count, self._ordered, self._last = count, ordered, 0

    def __call__(self, first: int, values: Integers) -> str:
        outside = (values < 0) | (values >= self._count)
        if outside.any():
            at = _first(outside)
            return f"points outside 0..{self._count - 1} in row {first + at}: {values[at]}"
        if self._ordered:
            back = np.diff(values, prepend=self._last) < 0
            if back.any():
                return f"is not in order in row {first + _first(back)}"
            self._last = int(values[-1])
        return ""


def _first(wrong: Flags) -> int:
    """The first row in which something is wrong."""
    return int(np.argmax(wrong.reshape(len(wrong), -1).any(axis=1)))
