"""Files of single robots and tools that describe a vehicle in keys of their own: one form each.

`rovers` has the Open Source Rover, Curio, Leo and TurtleBot3, `drives` controllers of ROS 1 and of vendors,
`frc` what PathPlanner and YAGSL write.
"""

from six_wheel.parameters.vendors.drives import DRIVES
from six_wheel.parameters.vendors.frc import FRC
from six_wheel.parameters.vendors.rovers import ROVERS

__all__ = ["VENDORS"]

VENDORS = (*ROVERS, *DRIVES, *FRC)
