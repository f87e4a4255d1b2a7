"""A file per command: its arguments, the run, and what it prints, draws and writes."""
