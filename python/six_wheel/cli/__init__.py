"""The command line: arguments in, exit code out; the one place that joins runs, pictures and reports.

`names` is what must be said at once, `app` the list of `commands`; neither loads what a command needs.
`report` and `demo` are written results, `benchmark` the core beside the reference.
"""
