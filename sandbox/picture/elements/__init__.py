"""How the elements of a mechanism look: each module adds items to a display list."""
