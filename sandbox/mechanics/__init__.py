"""Closed forms: the paper's equations and underactuated statics, pure functions of arrays."""
