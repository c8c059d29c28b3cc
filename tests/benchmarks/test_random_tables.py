"""Random tables never end in a traceback: a diagnosis, or one clear line.

`BENCH_RANDOM_TABLES` says how many are tried (default 12), `BENCH_RANDOM_FIRST` the first seed.
Searches are shortened - fewer evaluations, starts, replicates and rounds - so that a thousand
tables are affordable: every step is taken, but what is found is not what a diagnosis would find.
`BENCH_RANDOM_WHOLE=1` searches in full.
"""

from __future__ import annotations

import os
import warnings
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy import Options, diagnose, method
from bench.discrepancy.fit import search, starts
from bench.discrepancy.select import backfitting
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

TABLES = int(os.environ.get("BENCH_RANDOM_TABLES", "12"))
FIRST = int(os.environ.get("BENCH_RANDOM_FIRST", "0"))
WHOLE = os.environ.get("BENCH_RANDOM_WHOLE", "") == "1"
QUICK = Options(search_rows=60, fit_rows=40, confirm_rows=40)
MEASURED = (
    ("error_m", 0.0, 0.1),
    ("rx_power_dbm", -80.0, 6.0),
    ("first_path_power_dbm", -84.0, 6.0),
    ("noise_std", 40.0, 9.0),
    ("preamble_count", 500.0, 200.0),
)
SHORT: tuple[tuple[Any, str, Any], ...] = (
    (search, "EVALUATIONS", 5),
    (search, "EVALUATIONS_PER_PARAMETER", 1),
    (search, "MORE_DESCENTS", 1),
    (search, "FIT_MEMBERS", 2),
    (backfitting, "BACKFIT_EVALUATIONS", 3),
    (starts, "LINE_STEPS", (1.0, 0.25, 0.02)),
    (starts, "RATIO_STEPS", (1.0, 0.6)),
    (starts, "DECIBEL_STEPS", (1.0, 0.6, 0.2)),
    (starts, "SCATTERED_POINTS", 3),
    (starts, "ELSEWHERE_POINTS", 2),
    (starts, "DELAY_POINTS", 2),
    (method, "MOST_ROUNDS", 3),
)


def _values(rng: np.random.Generator, rows: int, centre: float, spread: float) -> np.ndarray:
    """Return numbers that are plain, constant, partly unknown, or wild."""
    value = rng.normal(centre, spread, rows)
    turn = rng.integers(6)
    if turn == 0:
        value[:] = centre
    if turn == 1:
        value[rng.random(rows) < 0.4] = np.nan
    if turn == 2:
        value[rng.integers(rows)] = np.inf
    if turn == 3:
        value = value * rng.choice([1.0, 30.0])
    return value


def _table(rng: np.random.Generator) -> Recordings:
    """Return a table with some of the columns that tables have."""
    links, per_link = int(rng.integers(1, 14)), int(rng.integers(1, 7))
    link = np.repeat(np.arange(links), per_link)
    rows = len(link)
    distance = rng.uniform(0.5, 30, links)[link] + rng.normal(0, 0.1, rows)
    frame = pd.DataFrame({"link": [f"l{i}" for i in link], "true_range_m": np.abs(distance) + 0.1})
    frame["error_m"] = _values(rng, rows, 0.05, 0.1)
    for name, centre, spread in (
        ("rx_power_dbm", -80, 6), ("first_path_power_dbm", -84, 6), ("noise_std", 40, 9),
        ("preamble_count", 500, 200), ("temperature_c", 20, 9), ("azimuth_deg", 0, 90),
        ("reply_time_s", 5e-4, 1e-4), ("tx_x_m", 0, 3), ("tx_y_m", 0, 3), ("rx_x_m", 0, 3),
        ("rx_y_m", 0, 3), ("tx_z_m", 1, 1), ("rx_z_m", 1, 1), ("humidity", 0, 1),
    ):  # fmt: skip
        if rng.random() < 0.4:
            frame[name] = _values(rng, rows, centre, spread)
    if rng.random() < 0.5:
        frame["time_s"] = np.tile(np.sort(rng.uniform(0, 60, per_link)), links)
    if rng.random() < 0.6:
        frame["tx"], frame["rx"] = [f"a{i % 3}" for i in link], [f"b{i % 2}" for i in link]
    if rng.random() < 0.3:
        kinds = [[], ["wall"], ["wall", "metal"]]
        frame["obstacles"] = [kinds[int(i)] for i in rng.integers(0, 3, rows)]
    if rng.random() < 0.3:
        frame["cir"], frame["first_path_index"] = _cirs(rng, rows), rng.uniform(2, 15, rows)
    return Recordings(frame, "random")


def _cirs(rng: np.random.Generator, rows: int) -> list[np.ndarray]:
    """Return a CIR of noise for every row."""
    samples = int(rng.integers(20, 60))
    return list(np.abs(rng.normal(0, 50, (rows, samples))).astype(np.float32))


def _beside(rng: np.random.Generator, recorded: Recordings) -> Recordings:
    """Return a simulated table of the same rows, up to three for each, measured anew.

    Some columns are missing.
    """
    frame = recorded.frame
    frame = frame.loc[np.repeat(np.arange(len(frame)), rng.integers(1, 4))].reset_index(drop=True)
    lost = [n for n in frame.columns if n not in ("link", "error_m") and rng.random() < 0.1]
    frame = frame.drop(columns=lost)
    for name, centre, spread in MEASURED:
        if name in frame:
            frame[name] = _values(rng, len(frame), centre, spread)
    if "cir" in frame:
        frame["cir"] = _cirs(rng, len(frame))
    return Recordings(frame, "random simulation")


def _counterpart(
    rng: np.random.Generator, recorded: Recordings, seed: int
) -> Recordings | Simulator:
    """Return a simulator, a table of the same rows, or one of other rows."""
    turn = rng.random()
    if turn < 0.4:
        return Simulator(Base(), (), seed)
    return _table(rng) if turn < 0.55 else _beside(rng, recorded)


@pytest.fixture(autouse=True)
def _shortened(monkeypatch: pytest.MonkeyPatch) -> None:
    for module, name, value in () if WHOLE else SHORT:
        monkeypatch.setattr(module, name, value)


@pytest.mark.parametrize("seed", range(FIRST, FIRST + TABLES))
def test_a_random_table_gives_a_diagnosis_or_one_clear_line(seed):
    rng = np.random.default_rng([seed, 99])
    recorded = _table(rng)
    simulated = _counterpart(rng, recorded, seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert _said(recorded, simulated)


def _said(recorded: Recordings, simulated: Recordings | Simulator) -> str:
    """Return the one line that a diagnosis, or a refusal, gives. Anything else comes through."""
    try:
        return diagnose(recorded, simulated, QUICK).headline
    except BenchError as problem:
        words = str(problem)
        return "" if "\n" in words else words
