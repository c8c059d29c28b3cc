"""A private folder that the processes of one run share while it lasts."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from backends import SCRATCH


@contextmanager
def scratch() -> Iterator[None]:
    """Name such a folder in the environment, for backends to keep there what they made once.

    What is compiled for a prediction need not be compiled again for a timing.
    """
    before = os.environ.get(SCRATCH)
    with tempfile.TemporaryDirectory(prefix="uwb-bench-") as folder:
        os.environ[SCRATCH] = folder
        try:
            yield
        finally:
            del os.environ[SCRATCH]
            if before is not None:
                os.environ[SCRATCH] = before
