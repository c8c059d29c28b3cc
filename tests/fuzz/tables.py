"""Recordings files: a small honest table with something wrong, or no table at all."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from tests.fuzz.hostile import NUMBERS, TEXTS, damaged, file_name, odd_file, text

ROWS, LINKS, WIDTH = 40, 8, 160
KNOWN = ("range_m", "true_range_m", "error_m", "first_path_index", "rx_power_dbm", "noise_std")
KNOWN += ("preamble_count", "sample_period_ns", "tx_x_m", "time_s", "temperature_c", "channel")
NAMES = ("link", "environment", "tx", "rx", "los", "obstacles")


def honest(rng: random.Random) -> pd.DataFrame:
    """Return noise in the exchange format: 40 ranges over 8 links in 2 environments."""
    draw = np.random.default_rng(rng.randrange(2**32))
    link = np.arange(ROWS) % LINKS
    true_m = draw.uniform(1, 9, LINKS)[link]
    cir = np.abs(draw.normal(0, 60, (ROWS, WIDTH)))
    cir[:, 7] += 8000
    frame = pd.DataFrame({"range_m": true_m + draw.normal(0.1, 0.05, ROWS), "true_range_m": true_m})
    frame["cir"] = list(cir.astype(np.float32))
    frame["first_path_index"], frame["rx_power_dbm"] = 6.3, draw.normal(-80, 3, ROWS)
    frame["noise_std"], frame["preamble_count"] = 45.0, 128.0
    frame["los"] = link % 2 == 0
    frame["environment"] = np.where(link < 4, "a", "b")
    frame["link"] = [f"l{k}" for k in link]
    frame["time_s"], frame["temperature_c"] = np.arange(ROWS) * 0.1, draw.uniform(10, 30, ROWS)
    return frame


def table_file(rng: random.Random, folder: Path) -> tuple[Path, str]:
    """Write a recordings file, honest, spoilt or none; return its path and what it is."""
    folder = folder / "recordings"
    folder.mkdir(exist_ok=True)
    path = folder / file_name(rng, rng.choice((".parquet", ".parquet", ".csv", ".csv.gz", ".txt")))
    if rng.random() < 0.12:
        return path, "table " + odd_file(rng, path)
    frame, done = honest(rng), []
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        spoil = rng.choice(_SPOILERS)
        done.append(spoil.__name__.strip("_"))
        frame = spoil(rng, frame)
    metadata = _metadata(rng)
    written = _write(frame, path, metadata)
    if not written:
        return path, "table that cannot be written, so absent"
    if rng.random() < 0.08:
        path.write_bytes(damaged(rng, path.read_bytes()))
        done.append("damaged")
    return path, "table " + (" + ".join(done) or "honest") + f" {sorted(metadata)}"


def _metadata(rng: random.Random) -> dict[str, Any]:
    if rng.random() < 0.5:
        return {}
    every = {
        "source": text(rng),
        "licence": text(rng),
        "simulator": rng.choice((text(rng), 'name = "x"', "[" * 100_000)),
        "seed": rng.choice(("1e400", "-1", "9" * 5000, "NaN", "")),
        "dropped": rng.choice(('{"x": 1e400}', '{"\\u001b[31m": 3}', "[" * 100_000, "[1]", "{}")),
        "recordings_version": rng.choice(("1", "2", "", "\x1b[2J")),
        "pandas": rng.choice(("{}", "[", '{"columns": 3, "index_columns": [9]}')),
    }
    return {name: every[name] for name in rng.sample(sorted(every), rng.randint(1, 3))}


def _write(frame: pd.DataFrame, path: Path, metadata: dict[str, Any]) -> bool:
    """Write the frame as its suffix says; False where pyarrow or pandas refuses it."""
    try:
        if path.suffix == ".parquet":
            table = pa.Table.from_pandas(frame, preserve_index=False)
            coded = {k: str(v).encode(errors="replace") for k, v in metadata.items()}
            pq.write_table(table.replace_schema_metadata(coded or None), path)
        else:
            plain = frame.map(_cell) if len(frame.columns) == len(set(frame.columns)) else frame
            plain.to_csv(path, index=False, errors="replace")
    except (pa.ArrowException, ValueError, TypeError, OverflowError, UnicodeError):
        path.unlink(missing_ok=True)
        return False
    return True


def _cell(value: Any) -> Any:
    return json.dumps(value.tolist()) if isinstance(value, np.ndarray) else value


def _one(rng: random.Random, frame: pd.DataFrame, names: tuple[str, ...]) -> str:
    have = [name for name in names if name in frame]
    return rng.choice(have) if have else str(frame.columns[0] if len(frame.columns) else "x")


def _no_column(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    return frame.drop(columns=[rng.choice(list(frame.columns))]) if len(frame.columns) else frame


def _only_errors(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    return pd.DataFrame({"error_m": np.linspace(-0.1, 0.4, len(frame))})


def _odd_numbers(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    share = rng.choice((0.05, 0.3, 1.0))
    values = [rng.choice(NUMBERS) if rng.random() < share else 1.0 for _ in range(len(frame))]
    return frame.assign(**{rng.choice(KNOWN): values})


def _texts_as_numbers(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    return frame.assign(**{rng.choice(KNOWN): [_clean(text(rng)) for _ in range(len(frame))]})


def _odd_names(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    values: list[Any] = [_clean(text(rng)) for _ in range(len(frame))]
    if values and rng.random() < 0.5:
        values[0] = None
    return frame.assign(**{rng.choice(NAMES): values})


def _numbers_as_names(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    kinds: list[Callable[[], Any]] = [
        lambda: np.arange(len(frame)) // 5,
        lambda: np.arange(len(frame)) / 5,
        lambda: [b"bytes"] * len(frame),
        lambda: pd.Categorical(["a", "b"] * (len(frame) // 2) + ["a"] * (len(frame) % 2)),
        lambda: pd.date_range("2026", periods=len(frame)),
        lambda: [[1, 2]] * len(frame),
        lambda: [{"a": 1}] * len(frame),
        lambda: [None] * len(frame),
        lambda: [2**62] * len(frame),
    ]
    return frame.assign(**{rng.choice((*NAMES, *KNOWN)): rng.choice(kinds)()})


def _odd_cirs(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    size = len(frame)
    kinds: list[Callable[[], Any]] = [
        lambda: [np.ones(rng.randrange(4), np.float32) for _ in range(size)],
        lambda: [np.zeros(WIDTH, np.float32)] * size,
        lambda: [np.full(WIDTH, rng.choice(NUMBERS), np.float32)] * size,
        lambda: [None] * size,
        lambda: ["1 2 3"] * size,
        lambda: [1.0] * size,
        lambda: [np.ones(WIDTH)] * size,
        lambda: [[[1.0], [2.0]]] * size,
        lambda: [np.ones(rng.choice((1, 156, 157, 2000)), np.float32)] * size,
    ]
    with np.errstate(all="ignore"):
        return frame.assign(cir=pd.Series(rng.choice(kinds)(), index=frame.index, dtype=object))


def _complex_cirs(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    parts = [[np.ones(rng.choice((3, WIDTH)), np.float32) for _ in range(len(frame))] for _ in "iq"]
    rest = frame.drop(columns=["cir"], errors="ignore") if rng.random() < 0.5 else frame
    return rest.assign(cir_i=parts[0], cir_q=parts[1])


def _more_columns(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    values = [rng.choice(NUMBERS) for _ in range(len(frame))]
    return frame.assign(**{_clean(text(rng)): values})


def _few_rows(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    return frame.iloc[: rng.choice((0, 1, 2, 5))]


def _one_link(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    return frame.assign(link=_clean(rng.choice(TEXTS)))


def _millimetres(rng: random.Random, frame: pd.DataFrame) -> pd.DataFrame:
    names = [name for name in ("range_m", "true_range_m") if name in frame]
    return frame.assign(**{n: frame[n] * 1000 for n in names if frame[n].dtype == np.float64})


def _clean(value: str) -> str:
    return value.replace("\ud800", "?")


_SPOILERS = (_no_column, _only_errors, _odd_numbers, _texts_as_numbers, _odd_names, _odd_cirs)
_SPOILERS += (_numbers_as_names, _complex_cirs, _more_columns, _few_rows, _one_link, _millimetres)
