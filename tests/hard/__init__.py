"""Difficult mechanisms: long chains, extreme mass ratios, stiff tendons, stacks.

``trials`` holds the mechanisms and their targets; ``truth`` the closed forms and independent
integrations that they are compared with.
"""
