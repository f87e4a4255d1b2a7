"""Motion over time: `profiles` of values, `controller` (limits along a motion), `planner`, `four_axle`."""
