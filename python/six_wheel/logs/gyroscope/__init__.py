"""A gyroscope in a log: `sources` are its columns or messages, `rates` what it says at the rows."""
