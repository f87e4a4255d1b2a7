"""Written reports of results, for the console and as Markdown with pictures beside it."""
