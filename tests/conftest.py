"""Settings shared by all tests."""

import os

from hypothesis import settings

# Runs are repeatable and judged by their answers, not by how busy the machine is.
settings.register_profile("default", derandomize=True, deadline=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))
