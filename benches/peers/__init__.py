"""Peers: the same six-wheel rover in plain Python, NumPy, numba and wpimath.

Each module is given the wheels and writes its own mathematics; none asks the core. All agree with it before
anything is timed (`contenders.py`).
"""
