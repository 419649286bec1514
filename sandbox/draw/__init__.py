"""Pictures and films of a recording. Only this package knows pygame; no display is needed."""

from sandbox.draw.film import quiet as quiet
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.video import render, save_picture, write_animation, write_frames

__all__ = ["FrameRenderer", "render", "save_picture", "write_animation", "write_frames"]
