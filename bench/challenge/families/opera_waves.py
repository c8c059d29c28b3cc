"""The opera's radio with its impulse responses: rows of `opera`, galleries and ropes that echo.

numpy and pandas alone; what can be hidden is in `opera_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import opera
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.opera_console import (
    METRES,
    OF_SIZES,
    PLACES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Console,
    edges,
    hiss,
    in_db,
    struck,
)
from bench.challenge.families.opera_stage import Cue
from bench.challenge.families.opera_wave_effects import LAWS, OF_RANGES, WAVES, go_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 150
OF_ROWS = np.repeat(np.arange(1, 9), [28, 20, 16, 12, 10, 7, 5, 3])
"""How many rows links have."""
FULL_DB = 121.0  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in opera.CAUSES.items() if name in OF_RANGES}
RARELY = ()
RAILS_M: Floats = np.array(
    [(x, y, z) for x in (1.6, 26.4) for y in (4.0, 10.5, 17.0) for z in (8.0, 13.4, 18.9)]
)
"""Where galleries have rails of steel, at winches."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the opera's own."""
    rng = np.random.default_rng([seed, 1506])
    rows = opera.picked(opera.cues(rng, "", OF_ROWS), drawn, near=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = opera.picked(opera.cues(rng, "", OF_ROWS), drawn, near=False)
        rows = rows.assign(link="in the evening, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = received(more, rng), received(more, rng)
    recorded, truth = _gone_through(clean, drawn, seed, 1), _gone_through(anew, drawn, seed, 2)
    found, plain, other, true = (
        _kept(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return opera.cues(np.random.default_rng([seed, 1506]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _gone_through(table, drawn, seed, len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _gone_through(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    console = Console(table, seed, np.random.default_rng([seed, 1507, side]))
    go_through(console, drawn.hidden, drawn.strength)
    return console.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is stored: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, listed=True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    both = zip(table["cir_i"], table["cir_q"], begin, strict=True)
    sizes = [
        np.hypot(real, imaginary)[at : at + SAMPLES].astype(np.float32)
        for real, imaginary, at in both
    ]
    rows = opera.as_written(table.drop(columns=["cir_i", "cir_q"]), listed)
    return rows.assign(cir=sizes, first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the opera's own radio makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = opera.summed(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _on_stage(rows, top, rng) + sigma[:, None] * hiss(rng, len(rows))
    edge = edges(wave, sigma)
    error = METRES * (edge + RISE - top) + rng.normal(0.0, 0.012, len(rows))
    level, first = in_db(wave, edge, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=edge,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _on_stage(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off rails, and among ropes.

    Rails are where they are; how much each returns is by chance of links.
    """
    cue = Cue(rows, 0, rng)
    portal = cue.through("metal") * cue.by_link(lambda n: rng.uniform(0.3, 0.76, n))
    wave = (1 - portal)[:, None] * _at_some_phase(rng, top)
    legs = [np.linalg.norm(end[:, None] - RAILS_M, axis=2) for end in (cue.at, cue.post)]
    late = (legs[0] + legs[1] - cue.way[:, None]) / METRES
    for rail in range(len(RAILS_M)):
        samples = late[:, rail].clip(4.4, 160.0)
        size = 0.38 * np.exp(-samples / 32.0)
        size = size * cue.by_link(lambda n: rng.gamma(1.6, 0.6, n).clip(max=2.6))
        wave += size[:, None] * _at_some_phase(rng, top + samples)
    since = np.clip(PLACES - top[:, None] - 3.0, 0.0, None)
    ropes = 0.021 * cue.by_link(lambda n: np.exp(rng.normal(0.0, 0.3, n)))[:, None]
    wave += ropes * np.exp(-since / 26.0) * (since > 0) * hiss(rng, len(rows))
    level = opera.on_stage(rows, rng) - 1.5  # rails and ropes add to what comes straight
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _at_some_phase(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row at some phase [n, k]."""
    return np.asarray(np.exp(1j * rng.uniform(0.0, 2 * np.pi, len(top)))[:, None] * struck(top))
