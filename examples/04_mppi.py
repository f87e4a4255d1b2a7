"""Follow a path by model predictive path integral control: sample, roll out, weigh, average.

NumPy samples and weighs; one call of `rollout_cost` says where the samples lead and what that asks of the
wheels.

Source: G. Williams et al., Information-theoretic model predictive control, IEEE T-RO 34(6), 2018.
"""

import time

import numpy as np

import six_wheel as sw

ROLLOUTS, STEPS, DT = 512, 32, 0.1  # 3.2 s ahead
SPEED, TEMPERATURE = 0.5, 0.01  # [m/s], of the costs' own unit [m]
SPREAD = np.array([0.1, 0.0, 0.25])  # of the samples [m/s, m/s, rad/s]
KNOTS = np.arange(0, STEPS + 1, 8)  # steps where they are drawn; in between they run straight

rover = sw.Rover.six_wheel(
    front_to_middle=0.5,
    middle_to_rear=0.5,
    track_width=0.8,
    middle_track_width=0.9,
    wheel_radius=0.15,
    steering_limit=0.6,
)
generator = np.random.default_rng(1)

# A path of bends, tight ones among them, with its poses a centimetre apart.
along = np.arange(0.0, 8.0, 0.01)
bend = np.stack([np.ones_like(along), np.zeros_like(along), 0.7 * np.sin(along / 1.2)], axis=1)
path = sw.integrate(bend, 0.01)
place = 0  # on the path, where the rover is
hats = np.maximum(1.0 - np.abs(np.arange(STEPS)[:, None] - KNOTS) / 8, 0.0)


def cost(found: sw.RolloutCost, place: int) -> np.ndarray:
    """Mean distance from where the path leads in time, and by how much the wheels are over their limits."""
    ahead = place + (np.arange(1, STEPS + 1) * SPEED * DT / 0.01).astype(int)
    wanted = path[np.minimum(ahead, len(path) - 1), :2]
    missed = np.hypot(*np.moveaxis(found.poses[:, 1:, :2] - wanted, -1, 0)).mean(axis=1)
    over = np.maximum(found.max_wheel_speed - 6.0, 0.0) + np.maximum(found.max_steering_rate - 1.5, 0.0)
    return missed + 0.1 * over + 10.0 * found.max_side_slip


pose, plan = path[0].copy(), np.tile([SPEED, 0.0, 0.0], (STEPS, 1))
steering, speeds = np.zeros(4), np.zeros(6)
found, errors, begun = None, [], time.perf_counter()
while place < len(path) - 100:
    noise = hats @ generator.normal(0.0, SPREAD, (ROLLOUTS, len(KNOTS), 3))
    noise[0] = 0.0  # the plan itself is among the samples
    found = rover.rollout_cost(plan + noise, DT, pose, previous=steering, out=found)
    costs = cost(found, place)
    weights = np.exp((costs.min() - costs) / TEMPERATURE)
    plan += np.tensordot(weights / weights.sum(), noise, axes=1)

    twist = rover.project(plan[0])
    rover.inverse(twist, previous=steering, out=(steering, speeds))
    pose = sw.integrate([twist], DT, pose)[-1]
    plan = np.concatenate([plan[1:], plan[-1:]])

    near = path[place : place + 100, :2]
    distances = np.hypot(*(near - pose[:2]).T)
    place += int(distances.argmin())
    errors.append(distances.min())

rate, errors = len(errors) / (time.perf_counter() - begun), 100 * np.array(errors)
print(f"{len(errors)} plans of {ROLLOUTS} rollouts of {STEPS} steps, {rate:.0f} a second")
print(f"off the path by {np.sqrt(np.mean(errors**2)):.1f} cm root mean square, {errors.max():.1f} cm at most")
