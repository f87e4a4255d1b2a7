"""The command line: a file per command, arguments in, exit code out; what joins runs, pictures and reports.

`words` is what must be said at once, `app` the list of commands; neither loads what a command needs.
"""
