"""``run.npz``: writing and reading it; equal bytes for equal content.

A zip that ``numpy.load`` reads too: arrays in order of their names, without compression, aligned so
that they can be mapped, then ``mechanism.json`` and ``info.json``; the run's id is the comment.
Reading checks names, sizes, shapes and types; a large recording is mapped from its file.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import re
import struct
import zipfile
from functools import partial
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import ARRAYS, IMPACT, LARGEST, Arrays, Recorded, dtype_of, pieces
from sandbox.errors import OutputError, SceneError
from sandbox.samples.outcome import Outcome, outcome_data, read_outcome
from sandbox.samples.samples import Samples
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits, check_limits, check_size
from sandbox.scene.read.load import checked, validated
from sandbox.scene.read.source import parse_source
from sandbox.wording import quoted, refuse_if

_refuse_if = partial(refuse_if, code="run-damaged")
FORMAT = 1
MECHANISM, INFO = "mechanism.json", "info.json"
IN_MEMORY = 1 << 26  # Bytes up to which a recording is read into memory; others are mapped
MAX_UNPACKED = 100_000_000  # Bytes that compressed members may have together
MAX_TEXT, MAX_INFO = 20_000_000, 1_000_000  # Bytes of mechanism.json and info.json
ANY = 10**18
LIMITS = Limits(problems=1, bodies=10_000, elements=100_000, values=1_000_000, steps=ANY,
                samples=ANY, recorded_bytes=ANY, frames=ANY)
PIECE = 1 << 20  # Bytes of a mapped array that are read at a time
ROUNDING = 1e-9
ALIGN, PADDING, SIZES = 64, "<HHH", 20  # of arrays; zip's padding; bytes of sizes beyond 4 GB
# keys of info that are left out where they are empty
RARE = ("events", "broke", "stopped", "controllers", "contact_solver")
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


def read(path: Path) -> tuple[Mechanism, Arrays, Outcome, str]:
    """The mechanism, arrays, outcome and id of a recording; the id is empty in version 0.1."""
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
    except Exception as error:  # zip, zlib, numpy and json each raise their own on garbage
        raise OutputError(f"{path} is not a recording, or damaged: {line_of(error)}",
                          code="run-damaged") from None


class _Reading:
    """One archive that is read; ValueError where it is damaged."""

    def __init__(self, path: Path, file: IO[bytes], archive: zipfile.ZipFile) -> None:
        self.path, self.file, self.archive = path, file, archive
        self.members: dict[str, zipfile.ZipInfo] = {}
        end, unpacked = file.seek(0, io.SEEK_END), 0
        for one in archive.infolist():
            name, stored = one.filename, one.compress_type == zipfile.ZIP_STORED
            packed = stored or one.compress_type == zipfile.ZIP_DEFLATED
            _refuse_if(not NAME.fullmatch(name), f"no part of a recording is called {quoted(name)}")
            _refuse_if(name in self.members, f"{name!r} is in it twice")
            _refuse_if(one.flag_bits & 1 or not packed,
                       f"{name!r} is encrypted, or packed in a way that is not read")
            _refuse_if(one.compress_size > end - one.header_offset or (
                stored and one.file_size != one.compress_size),
                f"{name!r} claims more bytes than there are")
            self.members[name] = one
            unpacked += 0 if stored else one.file_size
        _refuse_if(unpacked > MAX_UNPACKED, f"its compressed parts would take {unpacked} bytes; "
                   f"allowed: at most {MAX_UNPACKED}, or any size stored without compression")

    def _text(self, name: str, limit: int) -> str:
        _refuse_if(name not in self.members, f"it has no {name!r}")
        size = self.members[name].file_size
        _refuse_if(size > limit, f"{name!r} has {size} bytes; allowed: at most {limit}")
        return self.archive.read(name).decode()

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
        try:
            data = parse_source(self._text(MECHANISM, MAX_TEXT), limits=LIMITS).data
            if problems := check_size(data, LIMITS):
                raise SceneError(problems)
            mechanism = validated(Mechanism, data)
            if problems := check_limits(mechanism, LIMITS):
                raise SceneError(problems)
            return checked(mechanism)
        except SceneError as error:
            count = len(error.problems) - 1
            more = f", and {count} more" if count else ""
            raise ValueError(
                f"its mechanism is not valid: {line_of(error.problems[0])}{more}") from None

    def arrays(self, mechanism: Mechanism) -> Arrays:
        """The arrays in memory, or mapped where they are large; with plausible numbers."""
        found = {row: self.members[f"{row.name}.npy"] for row in ARRAYS
                 if f"{row.name}.npy" in self.members}
        large = sum(member.file_size for member in found.values()) > IN_MEMORY
        arrays = {row.name: self._array(row, member, mapped=large) for row, member in found.items()}
        time, end = arrays.get("time", np.zeros(0)), mechanism.run.duration + mechanism.run.step
        last = float(time.max(initial=0.0))
        _refuse_if(last > end * (1 + ROUNDING), f"array 'time' goes on after the run's end of "
                   f"{end:.9g} s: {last:.9g} s")
        for body, mass in zip(mechanism.bodies, arrays.get("body_mass", ()), strict=False):
            _refuse_if(body.motion == "dynamic" and np.isinf(mass), "array 'body_mass' has no "
                       f"weight for {quoted(body.name)}, which moves freely")
        return arrays

    def _array(self, row: Recorded, member: zipfile.ZipInfo, *, mapped: bool) -> NDArray[Any]:
        wanted, header = np.dtype(dtype_of(row.name)).newbyteorder("<"), np.lib.format
        with self.archive.open(member) as stream:
            try:
                if header.read_magic(stream) != (1, 0):
                    raise ValueError
                shape, by_columns, given = header.read_array_header_1_0(stream)
            except ValueError:
                raise ValueError(f"{member.filename!r} is not an array of numbers") from None
            begin = stream.tell()
            _refuse_if(given != wanted, f"array {row.name!r} holds {given}, expected {wanted}")
            _refuse_if(by_columns and len(shape) > 1,
                       f"array {row.name!r} is stored column by column")
            size = member.file_size
            _refuse_if(min(shape, default=0) < 0 or begin + 8 * math.prod(shape) != size,
                       f"array {row.name!r} of shape {shape} does not take the {size} bytes that "
                       "it has")
            # a member is read to its end, where its checksum is compared
            if not mapped or 0 in shape or member.compress_type != zipfile.ZIP_STORED:
                array = np.array(np.frombuffer(stream.read(), wanted)).reshape(shape)
            else:
                while stream.read(PIECE):
                    pass
                self.file.seek(member.header_offset)
                label, extra = struct.unpack("<26xHH", self.file.read(30))
                begin += member.header_offset + 30 + label + extra
                array = np.memmap(self.file, wanted, "r", begin, shape)
        bad = fault(row, array)
        _refuse_if(bad, f"array {row.name!r} {bad}")
        return array


def fault(row: Recorded, array: NDArray[Any]) -> str:
    """The first fault of the numbers of an array; empty if there is none."""
    last = -math.inf
    for piece in pieces(array):
        bad = ~(np.abs(piece) <= LARGEST)
        if row.also == "inf":
            bad = bad & (piece != np.inf) | (piece <= 0)
        elif row.also == "nan" or row.late:
            bad &= ~np.isnan(piece)
        if bad.any():
            return f"holds {piece[bad][0]:.6g}"
        if row.name == "time":
            if not (piece[0] > last and piece[0] >= 0 and (np.diff(piece) > 0).all()):
                return "does not rise"
            last = piece[-1]
    return ""


def line_of(error: object) -> str:
    """The first line of an error's text, at most 200 characters."""
    return (str(error).splitlines() or [type(error).__name__])[0][:200]
