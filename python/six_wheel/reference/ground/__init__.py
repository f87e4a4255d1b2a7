"""Rovers on real ground in plain NumPy: slow, exact, and without a line of the compiled core.

`suspension` is the frames of a rocker-bogie in a plane, `terrain` is a height grid seen through bilinear
interpolation; `chain` the suspension as a list of links and wheels; `settle` puts every wheel on the ground
by walking its whole rim, `bounds` says between which limits that is; `motion` relates the rates of body,
joints and wheels. World z up; a body stands at ``Rz(yaw) Ry(pitch) Rx(roll)``.
"""

from six_wheel.reference.ground.bounds import bounds, boxes
from six_wheel.reference.ground.chain import Chain, Link, Posture, Wheel, rocker_bogie
from six_wheel.reference.ground.motion import Contacts, forward, inverse, touch, traction
from six_wheel.reference.ground.settle import SettledPose, attitude, gap, gaps, settle
from six_wheel.reference.ground.terrain import Terrain

__all__ = [
    "Chain",
    "Contacts",
    "Link",
    "Posture",
    "SettledPose",
    "Terrain",
    "Wheel",
    "attitude",
    "bounds",
    "boxes",
]
__all__ += ["forward", "gap", "gaps", "inverse", "rocker_bogie", "settle", "touch", "traction"]
