"""Robot descriptions: a rover out of a URDF or xacro file, and a URDF out of a rover.

`tree` reads the file and composes its transforms, `wheels` decides from the geometry what is a wheel, what
steers it and which way its joint counts, `shapes` how large it is, `suspension` whether the tree is a
rocker-bogie, `read` makes the rover of it and keeps what was derived from where, `write` goes the other way.
"""

from six_wheel.robot_description.urdf.read import Robot, read_urdf
from six_wheel.robot_description.urdf.tree import ENDINGS
from six_wheel.robot_description.urdf.write import rover_urdf, suspension_urdf

__all__ = ["ENDINGS", "Robot", "read_urdf", "rover_urdf", "suspension_urdf"]
