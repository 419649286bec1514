"""A fingerprint of the compiled code's sources.

Numba keeps what it compiled, and takes it out again while the file of that one
function is unchanged; it does not look at the functions, the constants and the records
that it takes from elsewhere. A kernel that takes something from another file therefore
reads :data:`KERNELS` from an enclosing scope, which is a part of what Numba does look at, or
is put in line into one that does (``inline="always"``).
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from sandbox.kinds import elements

_FILES = ("advance.py", "bounded.py", "factor.py", "forces.py", "kernel.py", "memory.py", "native.py",
          "network.py", "rows.py", "snapshot.py", "solve.py", "state.py", "touching.py", "work.py")


def _hash(*files: Path) -> int:
    """A number that fits a machine word; to ask whether a text is empty would cost compiling."""
    digest = hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).digest()
    return int.from_bytes(digest[:7], "big") | 1


KERNELS = _hash(*(Path(__file__).with_name(name) for name in _FILES), Path(elements.__file__))
"""Changes when any source of the compiled code does."""
