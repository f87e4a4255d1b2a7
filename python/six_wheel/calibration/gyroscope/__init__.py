"""What a gyroscope errs by: `noise` from where the rover stands, `scale` against how it turned."""
