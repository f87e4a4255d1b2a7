"""Settled rovers beside MuJoCo: the chain as bodies, thin frictionless wheels, a height field."""

import math

import numpy as np
import pytest

import six_wheel as sw

from .grounds import hills, numbers_of

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
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


def test_a_physics_engine_comes_to_rest_in_the_same_place():
    rover, coarse = sw.RockerBogie.perseverance(), hills(12.0)
    ground = sw.Terrain(coarse, 0.1)
    # The same surface on lines four times as close, on which triangles are nearly bilinear.
    fine = 0.1 / FINE * np.arange(FINE * (len(coarse) - 1) + 1)
    xy = np.stack(np.meshgrid(np.minimum(fine, 12.0 - 1e-12), np.minimum(fine, 12.0 - 1e-12)), -1)
    heights = ground.height(xy)
    for pose in [(6.0, 6.0, 0.4), (5.0, 7.0, 2.0), (7.2, 4.6, -1.1)]:
        numbers = numbers_of(rover.settle(ground, pose))
        made, data = model(rover, heights, 0.1 / FINE, pose, numbers)
        for _ in range(3000):
            mujoco.mj_step(made, data)
        names = ("z", "roll", "pitch", "left_rocker", "left_bogie", "right_bogie")
        there = np.array([data.joint(name).qpos[0] for name in names])
        # Springs, wheels a millimetre wide, triangles: 5e-5 m and rad were seen.
        np.testing.assert_allclose(there, numbers, rtol=0, atol=2e-4)
