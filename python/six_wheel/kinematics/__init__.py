"""The thin floor over the compiled core, with NumPy only: names of its codes, poses, tracks, statuses,
errors.

`controller`, `four_axle`, `profiles`, `rollout_cost` and `statuses` are the values that the core takes and
returns; `rover_edit` makes a rover with other wheels; `geometry` and `poses` are SE(2); `odometry` has
tracks and dimensions. `errors`, `flags` and `lazy` serve every room above.
"""
