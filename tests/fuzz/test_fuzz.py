"""A hundred of the fuzz cases, so that CI sees some of them every time."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_a_hundred_hostile_cases_do_no_harm() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz", "--cases", "100", "--own-process", "0.01"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
