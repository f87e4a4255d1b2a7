"""Bags of ROS: `bag_files` finds and mends them, `messages` reads their topics, and of these `joint_bag` has
the joint states, `truth_bag` the poses and `imu_bag` the angular velocities.
"""
