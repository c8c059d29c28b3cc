"""`bench run`: what is wrong is said before anything is done."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner
from recordings_factory import make_recordings

from bench.cli.run import command
from bench.errors import BenchError
from bench.recordings import write_recordings


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


def test_a_run_of_which_every_pair_was_skipped_fails_with_the_reasons(tmp_path: Path) -> None:
    write_recordings(make_recordings(rows=24), tmp_path / "t.parquet")
    words = ["--model", "none", "--backend", "int8", "--data", str(tmp_path / "t.parquet")]
    with pytest.raises(BenchError, match=r"every pair was skipped; none on int8: .*no weights"):
        CliRunner().invoke(
            command, [*words, "--out", str(tmp_path / "out")], catch_exceptions=False
        )
    assert len(list((tmp_path / "out" / "runs").iterdir())) == 1
