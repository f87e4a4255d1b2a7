"""Find the wheel whose encoder lies: fit the twist robustly and look at the residuals."""

import numpy as np

import six_wheel as sw

rover = sw.Rover.preset("open_source_rover")
true_twist = (0.3, 0.0, 0.2)
steering, speeds = rover.inverse(true_twist)
speeds[2] *= 1.5  # the middle left encoder reads half as much again

for method in ("middle_wheels", "least_squares", "robust"):
    fit = rover.fit(steering, speeds, method=method)
    error = fit.twist[2] / true_twist[2] - 1
    print(f"{method:14} omega off by {error:8.2%}, largest residual at {fit.worst_wheel}")

weights = dict(zip(rover.wheel_names, rover.fit(steering, speeds, method="robust").weights, strict=True))
print("weights:", {name: float(np.round(weight, 4)) for name, weight in weights.items()})
