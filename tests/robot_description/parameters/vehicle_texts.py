"""Names and settings that tests of vehicle types share."""

from hypothesis import HealthCheck, settings

CORNERS = ["front_left", "front_right", "rear_left", "rear_right"]

unhurried = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=30
)
