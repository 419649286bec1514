"""Assemblies: what a scene writes in one part and a mechanism spells out in many elements."""
