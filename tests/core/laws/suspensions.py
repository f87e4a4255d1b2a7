"""The suspension of the tests."""

import six_wheel as sw
from six_wheel import RockerBogie  # noqa: F401  (the name that a repr refers to)

ROCKY = sw.RockerBogie.preset("rocky7")
