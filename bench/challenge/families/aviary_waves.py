"""The aviary's listeners with their impulse responses: rows of `aviary`, and what echoes.

numpy and pandas alone; what can be hidden is in `aviary_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import aviary
from bench.challenge.families.aviary_grounds import NESTBOXES_M, ON_MASTS, Watch
from bench.challenge.families.aviary_listener import (
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    UP,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Listener,
    arrivals,
    calls,
    loudness_db,
    murmur,
)
from bench.challenge.families.aviary_wave_effects import LAWS, OF_RANGES, WAVES, put_in
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 162
OF_ROWS = np.repeat(np.arange(1, 9), [25, 22, 18, 14, 11, 8, 5, 3])
"""How many rows links have."""
FULL_DB = 117.0  # of levels: a count for each symbol
LEAVES, FADES = 24, 24.0  # that return what comes, anywhere; samples in which these fade by e
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in aviary.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the aviary's own."""
    rng = np.random.default_rng([seed, 2107])
    rows = aviary.sorted_out(aviary.watches(rng, "", OF_ROWS), drawn, True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = aviary.elsewhere(aviary.watches(rng, "", OF_ROWS), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = received(more, rng), received(more, rng)
    found, truth = (_undergone(one, drawn, seed, k) for k, one in enumerate((clean, anew), 1))
    kept, plain, other, true = (
        _kept(one, drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(kept, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return aviary.watches(np.random.default_rng([seed, 2107]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _undergone(table, drawn, seed, 10 + len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _undergone(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    listener = Listener(table, seed, np.random.default_rng([seed, 2108, side]))
    put_in(listener, drawn.hidden, drawn.strength)
    return listener.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, listed="obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    first = table["first_path_index"].to_numpy(np.float64)
    begins = (np.floor(first).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    parts = zip(table["cir_i"], table["cir_q"], begins, strict=True)
    sizes = [np.hypot(i, q)[k : k + SAMPLES].astype(np.float32) for i, q, k in parts]
    rows = table.drop(columns=["cir_i", "cir_q"])
    return aviary.as_told(rows.assign(cir=sizes, first_path_index=first - begins), listed)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that nestboxes' own listeners make of rows, with complex waveforms."""
    top = WIDE_LEAD + UP + rng.random(len(rows))
    symbols, noise = aviary.counted(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _below_the_net(rows, top, rng)
    wave = wave + sigma[:, None] * murmur(rng, len(rows))
    at = arrivals(wave, sigma)
    kept = Watch(rows, 0, rng).by_link(lambda n: rng.logistic(0.0, 0.0036, n))
    error = METRES * (at + UP - top) + kept + 0.0125 * rng.standard_t(7, len(rows))
    level, first = (db - 20 * np.log10(full) for db in loudness_db(wave, at, sigma))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _below_the_net(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off masts, off leaves here and there.

    Of what is behind steel some comes straight; what masts return spreads as from thin cylinders.
    """
    watch = Watch(rows, 0, rng)
    steel = watch.through("metal") * watch.by_link(lambda n: 0.3 + 0.55 * rng.beta(1.8, 1.3, n))
    wave = (1 - steel)[:, None] * _call(rng, top)
    for x_m, y_m, _ in NESTBOXES_M[:ON_MASTS]:
        legs = [np.hypot(end[:, 0] - x_m, end[:, 1] - y_m) for end in (watch.there, watch.hung)]
        way = np.hypot(legs[0] + legs[1], watch.there[:, 2] - watch.hung[:, 2])
        late = ((way - watch.far) / METRES).clip(5.0, 180.0)
        thin = 0.52 * watch.far / np.sqrt(way * legs[0].clip(1.0) * legs[1].clip(1.0))
        thin = thin.clip(max=0.5) * watch.by_link(lambda n: rng.lognormal(-0.3, 0.5, n)).clip(max=2)
        wave = wave + thin[:, None] * _call(rng, top + late)
    for late in 4.2 + rng.exponential(FADES, (LEAVES, len(rows))).clip(max=95.0):
        size = 0.19 * np.exp(-late / 60.0) * rng.rayleigh(0.7, len(rows))
        wave = wave + size[:, None] * _call(rng, top + late)
    level = aviary.in_the_open(rows, rng) - 1.6  # what comes later adds to what comes straight
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _call(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row, at a phase by chance [n, k]."""
    return np.asarray(calls(top) * np.exp(2j * np.pi * rng.random(len(top)))[:, None])
