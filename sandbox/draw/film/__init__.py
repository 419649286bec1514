"""Pictures and films of a run, drawn with pygame."""
