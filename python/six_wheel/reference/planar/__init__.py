"""Rovers in the plane, in the order in which the modules build on each other.

`geometry` (poses), `wheels` (the wheel equation), `layouts` (the named lists of wheels), `estimate` (wheels
to twist), `admissible` (which twists are possible), `mobility`, and `rover`, where they come together;
`odometry` and `rollouts` integrate them.
"""
