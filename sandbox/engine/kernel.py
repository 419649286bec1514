"""How functions of the compiled step are compiled.

They are not kept on disk one by one: each is linked into the two that Python calls
(:mod:`sandbox.engine.advance`), and these are kept, under the fingerprint of all sources. Numba
would take a kept function out again though what it uses from another file had changed.
"""

from __future__ import annotations

from typing import Any

from numba import njit

kernel: Any = njit(error_model="numpy")
"""Compile a function where it is first used; a division by 0 gives inf or nan."""
