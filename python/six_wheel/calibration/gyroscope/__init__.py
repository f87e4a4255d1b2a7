"""Errors of a gyroscope: `noise` while the rover stands, `scale` against the rotation of the rover."""
