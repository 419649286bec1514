"""Kills: processes that write are killed at any moment, and what they leave is looked over.

``python -m tests.kills`` from a checkout; docs/extending.md says how to read what it prints.
"""
