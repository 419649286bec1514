"""Kills: processes that write are killed at any moment, and what they leave is looked over.

``python -m tests.kills`` from a checkout; docs/contributing.md describes it.
"""
