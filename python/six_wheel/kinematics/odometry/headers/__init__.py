"""Headers of tables: `columns` finds the quantity and unit of each, `joint_columns` those of wheels, joints and
the truth, `rate_columns` those of a gyroscope.
"""
