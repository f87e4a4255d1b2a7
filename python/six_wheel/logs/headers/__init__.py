"""Headers of tables: `columns` finds the quantity and unit of each, `joint_columns` those of joints,
`time_columns` stamps, `rate_columns` a gyroscope; `renamed` has what the owner of a table calls them,
`clock_times` reads times that are written as clocks show them.
"""
