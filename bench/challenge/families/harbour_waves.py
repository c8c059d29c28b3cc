"""The harbour's radio with its impulse responses: rows of `harbour`, waveforms of its own.

numpy and pandas alone; what can be hidden is in `harbour_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import harbour
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.harbour_effects import MOTION
from bench.challenge.families.harbour_radio import (
    NOTICED,
    SAMPLE_M,
    SIZES,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Frames,
    onsets,
    pulses,
    sums,
)
from bench.challenge.families.harbour_wave_effects import LAWS, OF_RANGES, WAVES, let_happen

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 178
RUNS, TURNS = 12, 2
FULL_SCALE_DB = 121.74  # of levels, at a pulse repetition of 64 MHz
FACES = 4  # of stacks and ships about, that return something on every link
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in harbour.CAUSES.items() if name in KNOWN}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the harbour's own."""
    rng = np.random.default_rng([421, seed])
    rows = harbour.of_mix(_rows(rng), drawn.same_mix, nearer=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = harbour.of_mix(_rows(rng), drawn.same_mix, nearer=False)
        rows = rows.assign(link="modelled " + rows["link"])
    simulated, again = (
        pd.concat([received(rows, rng) for _ in range(drawn.ratio)], ignore_index=True)
        for _ in ("simulated", "truth")
    )
    found, truth = (conceal(one, drawn, seed) for one in (clean, again))
    gone = [] if drawn.listed else ["obstacles"]
    found, clean, simulated, truth = (
        recorded(one).drop(columns=gone, errors="ignore")
        for one in (found, clean, simulated, truth)
    )
    return Tables(found, clean, simulated, truth)


def _rows(rng: np.random.Generator) -> pd.DataFrame:
    return harbour.shifted(rng, "", TURNS, RUNS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _rows(np.random.default_rng([421, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    frames = Frames(table, seed, np.random.default_rng([422, seed, len(table)]))
    let_happen(frames, drawn.hidden, drawn.strength)
    return frames.written().drop(columns=[] if drawn.listed else ["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES magnitudes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(index.astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    real, imaginary = (np.array(table[name].tolist()) for name in ("cir_i", "cir_q"))
    window = begin[:, None] + np.arange(SAMPLES)
    shown = np.take_along_axis(np.abs(real + 1j * imaginary), window, axis=1).astype(np.float32)
    kept = table.drop(columns=["cir_i", "cir_q", *MOTION])
    return kept.assign(cir=list(shown), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the harbour's own radio makes of rows, with complex waveforms."""
    count = len(rows)
    start = WIDE_LEAD + 1 + rng.random(count)
    symbols = 128.0 - rng.poisson(1.5, count)
    spread = 47.0 * rng.gamma(300, 1 / 300, count)
    waves = _arriving(rows, start, rng) * (symbols * 10 ** (FULL_SCALE_DB / 20))[:, None]
    noise = rng.standard_normal((*waves.shape, 2)) * spread[:, None, None]
    waves = waves + noise[..., 0] + 1j * noise[..., 1]
    index = np.round(onsets(waves, NOTICED * spread), 3)
    error = (index - start + 1.352) * SAMPLE_M + 0.013 * rng.standard_t(8, count)
    levels = {
        name: 10 * np.log10(energy / symbols**2) - FULL_SCALE_DB
        for name, energy in sums(waves, index).items()
    }
    return rows.assign(
        range_m=rows["true_range_m"] + error, error_m=error, **levels,
        noise_std=SIZES * spread, preamble_count=symbols, first_path_index=index,
        sample_period_ns=1.0016, channel=5, prf_mhz=64.0, tx_power_dbm=-14.3,
        cir_i=list(waves.real), cir_q=list(waves.imag),
    )  # fmt: skip


def _arriving(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is received in root mW: straight, by faces about, and from all the iron."""
    far, count = rows["true_range_m"].to_numpy(np.float64), len(rows)
    places, names = pd.factorize(rows["link"])
    level = -52.6 - 19.2 * np.log10(far) + (0.8 * rng.standard_t(7, len(names)))[places]
    iron = np.array([row == ["metal"] for row in rows["obstacles"]])
    straight = np.where(iron, rng.uniform(0.14, 0.42, count), 1.0)
    made = (straight * _turns(rng, count))[:, None] * pulses(start)
    for _ in range(FACES):
        late = (5 + rng.gamma(1.3, 16, len(names)))[places]
        size = (0.62 * rng.beta(2, 3.6, len(names)))[places] * _turns(rng, count)
        made = made + size[:, None] * pulses(start + np.minimum(late, 170))
    since = np.maximum(np.arange(WIDE_SAMPLES) - start[:, None] - 2, 0)
    rough = (
        rng.standard_normal((2, count, WIDE_SAMPLES)) * 0.022 * np.exp(-since / 34) * (since > 0)
    )
    return np.asarray(10 ** (level / 20)[:, None] / 1.3 * (made + rough[0] + 1j * rough[1]))


def _turns(rng: np.random.Generator, count: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(count)))
