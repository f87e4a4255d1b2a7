"""Records of drives: `reading` makes one of whatever holds poses over time, `plots` thins its columns."""
