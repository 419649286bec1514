"""Pictures and films of a recording. Only this package knows pygame; no display is needed."""

from sandbox.draw.film import quiet as quiet
