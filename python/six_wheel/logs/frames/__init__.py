"""Tables in memory: `table_headers` finds the columns of a rover in frames and dictionaries, `tabular_input`
reads these, arrays and Parquet files a piece at a time.
"""
