"""Pages and the live view: a browser draws the display list of a run."""
