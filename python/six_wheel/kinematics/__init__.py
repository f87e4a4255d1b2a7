"""The thin floor over the compiled core, with NumPy only: names of its codes, poses, tracks, statuses,
errors.

`controller`, `four_axle`, `profiles`, `statuses` and `objects` are the values that the core takes and
returns; `rover_edit` makes a rover with other wheels; `geometry`, `se2` and `poses` are SE(2); `odometry` has
tracks and dimensions. `errors`, `keywords` and `lazy` serve every room above; `config` is
what the machine does for a call.
"""
