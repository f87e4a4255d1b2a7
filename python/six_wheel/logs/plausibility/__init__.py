"""Plausibility of readings, checked before anything is computed from them.

`proposals` has the error and the options that settle it, `stamps` checks clocks, `jumps` counters that start
over, `whole_numbers` counts that go by another name, `motion` rates that no wheel has; `checks` puts a log
through all of them, chunk by chunk.
"""
