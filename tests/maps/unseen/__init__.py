"""Forms of a second known ground, drawn by seed and written without a look at `tests/maps/forms`."""
