"""Peak memory of a stretch of work."""

from __future__ import annotations

import subprocess
import sys

CODE = """
import numpy as np
from bench.measure.memory import PeakMemory, high_water_bytes
before = np.ones(40 * 2**17); del before          # 40 MB, given back: not ours
memory = PeakMemory()
kept = np.ones(10 * 2**17)
gone = np.ones(20 * 2**17); del gone
print(memory.peak_bytes() / 2**20, high_water_bytes() / 2**20)
"""


def test_peak_counts_what_was_given_back_but_nothing_earlier() -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=True, timeout=60
    )
    peak_mb, high_mb = map(float, done.stdout.split())
    # Where the mark cannot be set back (macOS, Windows) the 40 MB hide the 30: 10 are seen.
    assert (29 if sys.platform == "linux" else 9) <= peak_mb < 34
    assert high_mb > peak_mb
