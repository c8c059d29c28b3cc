"""The crag's radio with its impulse responses: rows of `crag`, holds and sides that echo.

numpy and pandas alone; what can be hidden is in `crag_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import crag
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.crag_belay import (
    METRES,
    OF_SIZES,
    PLACES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Bolt,
    first_paths,
    grain,
    humps,
    metered,
)
from bench.challenge.families.crag_effects import by_roof
from bench.challenge.families.crag_wall import Ascent
from bench.challenge.families.crag_wave_effects import LAWS, OF_RANGES, WAVES, put_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 15, 126
OF_LINKS = (28, 26, 20, 16, 11, 7)  # how many links have one row, two rows and so on
FULL_DB = 120.5  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(one for one in WAVES if one not in LAWS))
CAUSES = {one: crag.CAUSES[one] for one in crag.CAUSES if one in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the crag's own."""
    rng = np.random.default_rng([seed, 1216])
    rows = crag.mixed(crag.ascents(rng, "", OF_LINKS), drawn, 1)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = crag.mixed(crag.ascents(rng, "", OF_LINKS), drawn, -1)
        rows = rows.assign(link="other evening, " + rows["link"])
    more = pd.concat([rows for _ in range(drawn.ratio)], ignore_index=True)
    simulated, true = received(more, rng), received(more, rng)
    found, true = (_through(one, drawn, [seed, k]) for k, one in enumerate((clean, true)))
    found, clean, simulated, true = (
        _cut(one, drawn.listed) for one in (found, clean, simulated, true)
    )
    return Tables(found, clean, simulated, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return crag.ascents(np.random.default_rng([seed, 1216]), "", OF_LINKS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _through(table, drawn, [seed, len(table)])
    return found if drawn.listed else found.drop(columns="obstacles")


def _through(table: pd.DataFrame, drawn: Draw, of: list[int]) -> pd.DataFrame:
    bolt = Bolt(table, of[0], np.random.default_rng([1217, *of]))
    put_through(bolt, drawn.hidden, drawn.strength)
    return bolt.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut(table, True)


def _cut(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    path = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(path.astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = [
        np.hypot(real[at : at + SAMPLES], imaginary[at : at + SAMPLES]).astype(np.float32)
        for real, imaginary, at in zip(table["cir_i"], table["cir_q"], begin, strict=True)
    ]
    rows = crag.told(table, listed).drop(columns=["cir_i", "cir_q"])
    return rows.assign(cir=sizes, first_path_index=path - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the crag's own radio makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    sums, noise = crag.summed(rows, rng)
    sigma, full = noise / OF_SIZES, sums * 10 ** (FULL_DB / 20)
    waves = full[:, None] * _in_the_hall(rows, top, rng)
    waves = waves + sigma[:, None] * grain(rng, len(rows))
    path = first_paths(waves, sigma)
    error = METRES * (path + RISE - top) + 0.0065 * rng.standard_t(6.0, len(rows))
    level, first = metered(waves, path, sigma) - 20 * np.log10(full)
    told = {
        "error_m": error,
        "range_m": rows["true_range_m"] + error,
        "rx_power_dbm": level,
        "first_path_power_dbm": first,
        "first_path_index": path,
        "sample_period_ns": np.full(len(rows), SAMPLE_NS),
        "noise_std": noise,
        "preamble_count": sums,
    }
    return rows.assign(**told, cir_i=list(waves.real), cir_q=list(waves.imag))


def _in_the_hall(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by the roof, off clusters of holds."""
    ascent = Ascent(rows, 0, rng)
    steel = 1 - ascent.has("metal") * ascent.each(lambda n: rng.uniform(0.4, 0.75, n))
    ways = [(0 * top, steel), ((by_roof(ascent) / METRES).clip(5.0, 130.0), _glint(ascent, 0.22))]
    for begin in (4.6, 11.0, 24.0):  # walls climb away from who is heard, each with its holds
        late = begin + begin * ascent.each(lambda n: rng.gamma(2.0, 0.2, n))
        for _ in range(3):
            size = _glint(ascent, 0.34) * np.exp(-late / 22.0)
            ways.append((late, size))
            late = late + ascent.each(lambda n: rng.exponential(2.6, n))
    waves = np.zeros((len(rows), WIDE_SAMPLES), np.complex128)
    for late, size in ways:
        phase = np.exp(2j * np.pi * rng.random(len(rows)))
        waves += (size * phase)[:, None] * humps(top + late)
    past = np.maximum(PLACES - top[:, None] - 3.0, 0.0)
    rest = ascent.each(lambda n: rng.uniform(0.015, 0.04, n))[:, None] * np.exp(-past / 28.0)
    waves += rest * (past > 0) * grain(rng, len(rows))
    level = crag.off_walls(rows, rng) - 4.3  # a pulse has more than its top
    return np.asarray(10 ** (level[:, None] / 20) * waves)


def _glint(ascent: Ascent, usual: float) -> Floats:
    """Return how large an echo of each link is, next to what comes straight, [n]."""
    return ascent.each(lambda n: usual * ascent.rng.weibull(1.8, n).clip(max=1.9))
