"""Errors of a log that no fit removes: `units` (logs that fit far better if read another way), and `slip`."""
