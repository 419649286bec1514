"""Random untrusted input, reproducible from its seed: ``python -m tests.fuzz``."""
