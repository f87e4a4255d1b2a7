"""A gyroscope in a log: `sources` reads it, `links` says how it is mounted, `rates` brings it to the rows."""
