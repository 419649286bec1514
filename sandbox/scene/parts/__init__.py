"""Parts: one entry of a scene, many elements of a mechanism."""
