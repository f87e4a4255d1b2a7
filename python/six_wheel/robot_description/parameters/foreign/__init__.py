"""Files of others that describe a vehicle in keys of their own: one form each.

Each robot or vendor has a table, a .toml file, which `read_tables` reads. No tables: `steering` for the
cars of ros2_controllers, `layouts`, `yagsl` for files beside a file, `limits`, and the `names` of joints.
"""
