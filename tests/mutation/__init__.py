"""Mutants: one small fault at a time is put into a copy of the package, and tests have to notice.

``python -m tests.mutation`` from a checkout; docs/extending.md says how to read what it prints.
"""
