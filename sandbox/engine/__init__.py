"""The engine: a mechanism stepped by pymunk, with tendons and dampers of its own."""
