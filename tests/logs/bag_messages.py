"""Messages of a drive, as rosbags writes them."""

import numpy as np

START = 1_700_000_000_000_000_000  # [ns]


def motion(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stamps [ns], steering angles and wheel angles of a rover that winds along."""
    k = np.arange(n)
    steering = 0.3 * np.sin(0.1 * k[:, None] + np.arange(4))
    return START + 50_000_000 * k, steering, k[:, None] * (1.0 + 0.1 * np.arange(6)) / 7
