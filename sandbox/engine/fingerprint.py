"""A fingerprint of the compiled code's sources.

Numba keeps what it compiles on disk, and takes it out again while the file of that one function
and what its enclosing scope gives it are unchanged; it does not look at the functions, the
constants and the records that it takes from elsewhere. What is kept therefore reads
:data:`KERNELS` from an enclosing scope: that is only what Python calls
(:mod:`sandbox.engine.advance`). All else (:mod:`sandbox.engine.kernel`) is linked into it and not
kept.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from sandbox.kinds import elements
from sandbox.model import programs

_FILES = ("advance.py", "bounded.py", "breaks.py", "buoyancy.py", "candidates.py", "cord_state.py",
          "ends.py", "factor.py", "fluid_report.py", "fluid_state.py", "fluids.py", "forces.py",
          "formulas.py", "impacts.py", "joint_state.py", "kernel.py", "laws.py", "lemke.py",
          "load_state.py", "loads.py", "memory.py", "native.py", "network.py", "report.py",
          "rows.py", "rubs.py", "servos.py", "slips.py", "snapshot.py", "solve.py", "state.py",
          "teeth.py", "tie_state.py", "ties.py", "touch_state.py", "touching.py", "work.py")


def _hash(*files: Path) -> int:
    """A number that fits a machine word; to ask whether a text is empty would cost compiling."""
    digest = hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).digest()
    return int.from_bytes(digest[:7], "big") | 1


KERNELS = _hash(*(Path(__file__).with_name(name) for name in _FILES), Path(elements.__file__),
                Path(programs.__file__)) ^ int(programs.LARGEST_EXPONENT)
"""Changes when any source of the compiled code does."""
