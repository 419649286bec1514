"""Set A and Set G of the verification cases, so that their numbers are written down once.

Test folders are packages of their own, without a common parent: hence by path.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

_FILE = Path(__file__).parents[1] / "verification" / "sets.py"
_spec = importlib.util.spec_from_file_location("reference_fingers", _FILE)
_module = importlib.util.module_from_spec(_spec)
sys.modules[_spec.name] = _module  # dataclasses look their module up
_spec.loader.exec_module(_module)

SET_A, SET_G, SET_G_TABLE = _module.SET_A, _module.SET_G, _module.SET_G_TABLE
FingerSet, DiscRow = _module.FingerSet, _module.DiscRow
