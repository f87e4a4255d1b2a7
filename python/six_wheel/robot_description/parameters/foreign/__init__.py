"""Files of others that describe a vehicle in keys of their own: one form each.

`ros2` has the controllers of ros2_controllers with their `keys`, `steering` the cars among them; `drives` has
those of ROS 1 and of vendors, `rovers` the Open Source Rover, Curio, Leo and TurtleBot3, `frc` what
PathPlanner and YAGSL write. What several need: `limits`, and the `names` that they have for joints.
"""
