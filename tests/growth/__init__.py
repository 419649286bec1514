"""Scenes that grow in one kind of thing, to find what ``check`` does more often than it has to."""
