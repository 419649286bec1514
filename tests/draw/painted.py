"""Frames of a recording, as tests look at them."""

from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames


def frames_of(run, *, enlarge=2, **options):
    return Frames(Picture(run, **options), enlarge)
