"""Inputs of strangers by the thousand, each made again from its seed: ``python -m tests.fuzz``."""
