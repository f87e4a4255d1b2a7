"""Settled rovers beside MuJoCo: the chain as bodies, thin frictionless wheels, a height field."""

import math
import os

import numpy as np
import pytest

import six_wheel as sw

from .grounds import hills, numbers_of, random_poses

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
SOAK = int(os.environ.get("SOAK", "1"))
FINE = 4  # samples per cell: MuJoCo's triangles then follow the bilinear surface to 1e-4 m


def model(rover, heights, spacing, pose, numbers):
    """The rover in MuJoCo where the core says it stands, free but for x, y and yaw."""
    of, radius = rover.dimensions, rover.dimensions["wheel_radius"]
    rows, columns = heights.shape
    low, high = float(heights.min()), float(heights.max())
    half = spacing * (columns - 1) / 2

    def wheel(place):
        return (
            f'<geom type="cylinder" size="{radius} 0.0005" pos="{place[0]} {place[1]} {place[2]}" '
            'euler="90 0 0" mass="0.2"/>'
        )

    ball = '<geom type="sphere" size="0.02" mass="2" contype="0" conaffinity="0"/>'
    sides, mirrors = "", {"left": 1, "right": -1}
    for name, side in mirrors.items():
        mirror = np.array([1, side, 1])
        at = {k: np.array(of[k]) * mirror for k in list(of)[:5]}
        pivot, to_bogie = (" ".join(map(str, at[k])) for k in ("rocker_pivot", "rocker_to_bogie"))
        sides += f"""
        <body name="{name}_rocker" pos="{pivot}">
          <joint name="{name}_rocker" axis="0 1 0"/>{ball}
          {wheel(at["rocker_to_front"])}
          <body name="{name}_bogie" pos="{to_bogie}">
            <joint name="{name}_bogie" axis="0 1 0"/>{ball}
            {wheel(at["bogie_to_middle"])}{wheel(at["bogie_to_rear"])}
          </body>
        </body>"""
    x, y, yaw = pose
    stiff = 'friction="0 0 0" condim="1" solref="0.004 1" solimp="0.99 0.999 0.0001"'
    chassis = f'<geom type="sphere" size="0.05" pos="0 0 {of["rocker_pivot"][2]}" mass="20"'
    text = f"""
    <mujoco>
      <option timestep="0.002" gravity="0 0 -9.81"/>
      <compiler angle="degree"/>
      <default><joint damping="20"/><geom {stiff}/></default>
      <asset>
        <hfield name="ground" nrow="{rows}" ncol="{columns}" size="{half} {half} {high - low} 1"/>
      </asset>
      <worldbody>
        <geom type="hfield" hfield="ground" pos="{half} {half} {low}"/>
        <body name="plan" pos="{x} {y} 0" euler="0 0 {math.degrees(yaw)}">
          <body name="body">
            <joint name="z" type="slide" axis="0 0 1"/>
            <joint name="pitch" axis="0 1 0"/>
            <joint name="roll" axis="1 0 0"/>
            {chassis} contype="0" conaffinity="0"/>
            {sides}
          </body>
        </body>
      </worldbody>
      <equality>
        <joint joint1="right_rocker" joint2="left_rocker" polycoef="0 -1 0 0 0" solref="0.004 1"/>
      </equality>
    </mujoco>"""
    made = mujoco.MjModel.from_xml_string(text)
    made.hfield_data[:] = ((heights - low) / (high - low)).ravel()
    data = mujoco.MjData(made)
    z, roll, pitch, rho, left, right = numbers
    start = {"z": z + 0.002, "roll": roll, "pitch": pitch, "left_rocker": rho, "right_rocker": -rho}
    start |= {"left_bogie": left, "right_bogie": right}
    for name, value in start.items():
        data.joint(name).qpos[0] = value
    return made, data


def finer(ground, size):
    """The same surface on lines four times as close, on which triangles are nearly bilinear."""
    fine = np.minimum(0.1 / FINE * np.arange(round(FINE * size / 0.1) + 1), size - 1e-12)
    return ground.height_at(np.stack(np.meshgrid(fine, fine), -1))


def at_rest(rover, heights, pose, numbers, steps=3000):
    """Pose at which MuJoCo comes to rest, and its remaining speed."""
    made, data = model(rover, heights, 0.1 / FINE, pose, numbers)
    mujoco.mj_step(made, data, steps)
    names = ("z", "roll", "pitch", "left_rocker", "left_bogie", "right_bogie")
    return np.array([data.joint(name).qpos[0] for name in names]), np.abs(data.qvel).max()


def test_a_physics_engine_comes_to_rest_in_the_same_place():
    rover, size = sw.RockerBogie.preset("perseverance"), 12.0
    ground = sw.Terrain(hills(size), 0.1)
    heights = finer(ground, size)
    for pose in [(6.0, 6.0, 0.4), (5.0, 7.0, 2.0), (7.2, 4.6, -1.1)]:
        numbers = numbers_of(rover.settle(ground, pose))
        there, _ = at_rest(rover, heights, pose, numbers)
        # Springs, wheels a millimetre wide, triangles: 5e-5 m and rad were seen.
        np.testing.assert_allclose(there, numbers, rtol=0, atol=2e-4)


def allowed(ground, contacts, normals):
    """Largest difference of MuJoCo's model [m, rad], with levers of half a metre.

    Springs as on hills; wheels half a millimetre to either side on slopes; triangles, which leave a cell's
    bilinear surface by a quarter of its twist.
    """
    column, row = np.floor(contacts[:, :2] / 0.1).astype(int).T
    high = ground.heights
    twist = high[row, column] + high[row + 1, column + 1] - high[row + 1, column] - high[row, column + 1]
    slope = np.hypot(normals[:, 0], normals[:, 1]) / normals[:, 2]
    return 2e-4 + 2 * (0.0005 * slope + np.abs(twist) / FINE**2 / 4).max()


@pytest.mark.parametrize("cover", [0.0, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("name", ["perseverance", "curiosity"])
def test_so_it_does_among_rocks(name, cover):
    """Wherever every wheel carries a share of the weight: `SOAK=n` for n times as many poses."""
    rover, size = sw.RockerBogie.preset(name), 12.0
    worst, tried = 0.0, 0
    for seed in range(SOAK):
        ground = sw.Terrain.yard(size, 0.1, cover=cover, seed=seed)
        heights = finer(ground, size)
        poses = random_poses(4, size, 4.0, seed)
        stand = rover.settle(ground, poses)
        # As the masses of the model are: the chassis, and balls where the joints are.
        loads = rover.stability(stand, mass=1.0).loads
        for k in np.nonzero((loads > 0.02).all(-1))[0][:2]:
            numbers = numbers_of(rover.settle(ground, poses[k]))
            there, _ = at_rest(rover, heights, poses[k], numbers)
            error = np.abs(there - numbers).max() / allowed(ground, stand.contacts[k], stand.normals[k])
            worst, tried = max(worst, error), tried + 1
    print(f"{name}, cover {cover:.0%}: {tried} poses, at most {worst:.2f} of what triangles and springs make")
    assert tried >= SOAK
    assert worst <= 1
