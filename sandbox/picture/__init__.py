"""Pictures of a recording: one display list, painted as films, stills and pages."""

import os

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # pygame greets on standard output
