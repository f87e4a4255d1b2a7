"""Rovers on uneven ground: a `run` in three dimensions, a chain from the `side`, a map's `safety`."""
