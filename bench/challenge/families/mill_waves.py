"""The mill's radio with its impulse responses: rows of `mill`, and a receiver of its own.

numpy and pandas alone; what can be hidden is in `mill_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import mill
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.mill_effects import HALL_M, PRIVATE
from bench.challenge.families.mill_trace import (
    DETECT,
    PULSE,
    RAYLEIGH,
    SAMPLE_M,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Trace,
    edges,
    three,
)
from bench.challenge.families.mill_wave_effects import LAST, LAWS, OF_RANGES, WAVES, change

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 12, 160
RUNS, REPEATS = 12, 2
OFFSET_DB = 113.77  # of levels, at a pulse repetition of 16 MHz
WALLS = (0.28, 0.34, 0.23, 0.3, 0.2, 0.16)  # sizes of what walls, floor and roof return
KNOWN = tuple(dict.fromkeys((*OF_RANGES, *(name for name in WAVES if name not in LAWS))))
CAUSES = {name: mill.CAUSES[name] for name in KNOWN if name in mill.CAUSES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the mill's own."""
    rng = np.random.default_rng([seed, 221])
    rows = mill.mixed(mill.swung(rng, "", REPEATS, RUNS), "" if drawn.same_mix else "near")
    clean = received(rows, rng)
    found = conceal(clean, drawn, seed)
    if not drawn.paired:
        rows = mill.mixed(mill.swung(rng, "", REPEATS, RUNS), "" if drawn.same_mix else "far")
        rows = rows.assign(link="sim-" + rows["link"])
    more = pd.concat([received(rows, rng) for _ in range(drawn.ratio)], ignore_index=True)
    again = pd.concat([received(rows, rng) for _ in range(drawn.ratio)], ignore_index=True)
    gone = [] if drawn.listed else ["obstacles"]
    found, clean, more, truth = (
        recorded(one).drop(columns=gone, errors="ignore")
        for one in (found, clean, more, conceal(again, drawn, seed))
    )
    return Tables(found, clean, more, truth)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return mill.swung(np.random.default_rng([seed, 221]), "", REPEATS, RUNS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    trace = Trace(table, seed, np.random.default_rng([seed, 222, len(table)]))
    for name in sorted(drawn.hidden, key=lambda one: one in LAST and 1 + LAST.index(one)):
        change(trace, name, drawn.strength)
    return trace.logged().drop(columns=[] if drawn.listed else ["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES magnitudes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(int) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    whole = np.hypot(*(np.stack(list(table[name])) for name in ("cir_i", "cir_q")))
    shown = np.take_along_axis(whole, begin[:, None] + np.arange(SAMPLES), axis=1)
    out = table.drop(columns=["cir_i", "cir_q", *PRIVATE])
    return out.assign(cir=list(shown.astype(np.float32)), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the mill's own radio makes of the rows, with complex waveforms."""
    count = len(rows)
    start = WIDE_LEAD + rng.random(count)
    symbols = rng.integers(492, 513, count).astype(np.float64)
    sigma = 74.0 * rng.lognormal(0, 0.05, count)
    cir = _ways(rows, start, rng) * (symbols * 10 ** (OFFSET_DB / 20))[:, None]
    hiss = rng.normal(size=(2, *cir.shape)) * sigma[:, None]
    cir = cir + hiss[0] + 1j * hiss[1]
    index = np.round(edges(cir, DETECT * sigma) * 64) / 64
    error = (index - start + 1.2) * SAMPLE_M + rng.normal(0, 0.014, count)
    level = [10 * np.log10(e / symbols**2) - OFFSET_DB for e in
             ((np.abs(cir) ** 2).sum(axis=1), three(cir, index))]  # fmt: skip
    return rows.assign(
        range_m=rows["true_range_m"] + error, error_m=error, rx_power_dbm=level[0],
        first_path_power_dbm=level[1], noise_std=RAYLEIGH * sigma, preamble_count=symbols,
        first_path_index=index, sample_period_ns=1.0016,
        cir_i=list(cir.real), cir_q=list(cir.imag),
    )  # fmt: skip


def _ways(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is received in root mW: straight, by the six faces of the hall, and diffuse."""
    count, far = len(rows), rows["true_range_m"].to_numpy(np.float64)
    codes, links = pd.factorize(rows["link"])
    level = -65.0 - 18.5 * np.log10(far) + rng.normal(0, 1.0, len(links))[codes]
    height = 10 ** (level / 20) / np.sqrt(2 * PULSE)
    iron = np.array(["metal" in row for row in rows["obstacles"]])
    first = np.where(iron, 10 ** (-rng.uniform(9, 17, count) / 20), 1.0)
    made = (height * first * np.exp(2j * np.pi * rng.random(count)))[:, None] * _pulse(start)
    for size, length in zip(WALLS, _lengths(rows), strict=True):
        turned = size * height * far / length * np.exp(2j * np.pi * rng.random(count))
        made = made + turned[:, None] * _pulse(start + (length - far) / SAMPLE_M)
    return np.asarray(made + height[:, None] * _haze(start, rng))


def _pulse(at: Floats) -> Floats:
    """Return pulses [n, k] whose middles are at samples [n]."""
    gap = np.minimum(np.abs(np.arange(WIDE_SAMPLES) - at[:, None]), 60)
    return np.asarray(1 / np.cosh(gap / PULSE))


def _lengths(rows: pd.DataFrame) -> list[Floats]:
    """Return how long the ways by each of the six faces of the hall are, in m [n]."""
    ends = [rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx")]
    out = []
    for axis, size in enumerate(HALL_M):
        for wall in (0.0, size):
            gap = ends[0] - ends[1]
            gap[:, axis] = 2 * wall - ends[0][:, axis] - ends[1][:, axis]
            out.append(np.linalg.norm(gap, axis=1))
    return out


def _haze(start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what machines scatter, next to a pulse of height 1: rises quickly, falls slowly."""
    since = np.maximum(np.arange(WIDE_SAMPLES) - start[:, None] - 1, 0)
    power = 0.0022 * (1 - np.exp(-since / 4)) * np.exp(-since / 21)
    drawn = rng.normal(size=(2, *power.shape))
    rough = np.sqrt(power / 2) * (drawn[0] + 1j * drawn[1])
    return np.asarray((rough + np.roll(rough, 1, axis=1)) / np.sqrt(2))
