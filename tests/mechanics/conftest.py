"""Property tests without a time limit an example: a loaded machine is no wrong formula."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("patient", deadline=None)
settings.load_profile("patient")
