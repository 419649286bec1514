"""Hard mechanisms: those that a user brings, each with a truth that owes nothing to the engine.

Long chains, heavy loads on light links, stiff cords that carry them, closed and redundant loops,
light boxes under heavy ones, balls that touch. ``trials`` has the mechanisms and what is wanted
of each, ``truth`` the closed forms and integrations; ``python -m tests.hard`` measures them all.
"""
