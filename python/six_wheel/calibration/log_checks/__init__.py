"""What no fit can mend: `readings` of a log or its truth that are others than they seem, and `slips`."""
