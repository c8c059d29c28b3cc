"""`bench run`: what is wrong is said before anything is done."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from bench.cli.run import command
from bench.errors import BenchError


@pytest.mark.parametrize("level", ["1.5", "0", "-1"])
def test_an_impossible_level_of_intervals_is_refused_before_any_work(
    tmp_path: Path, level: str
) -> None:
    words = ["--model", "none", "--backend", "fp32", "--intervals", level]
    with pytest.raises(BenchError, match="expected a level between 0 and 1"):
        CliRunner().invoke(
            command, [*words, "--out", str(tmp_path / "out")], catch_exceptions=False
        )
    assert not (tmp_path / "out").exists()
