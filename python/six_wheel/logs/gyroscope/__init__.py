"""A gyroscope in a log: `links` says how it is mounted, `rates` brings it to the rows."""
