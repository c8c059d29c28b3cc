"""The rink's radio with its impulse responses: rows of `rink`, boards and trusses that return.

numpy and pandas alone; what can be hidden is in `rink_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import rink
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.rink_ice import RINK_M
from bench.challenge.families.rink_radio import (
    INDEX,
    METRES,
    OF_NOISE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Record,
    bursts,
    crackle,
    crests,
    levels,
)
from bench.challenge.families.rink_wave_effects import LAWS, OF_RANGES, WAVES, skate

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 14, 136
ROUNDS = (1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 6)
FULL_DB = 104.0  # of levels
LATE = 0.5  # samples by which clean pulses are timed after their crests, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in rink.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the rink's own."""
    rng = np.random.default_rng([855, seed])
    rows = rink.chosen(_shifts(rng), None if drawn.same_mix else "near")
    clean = received(rows, rng)
    if not drawn.paired:
        rows = rink.chosen(_shifts(rng), None if drawn.same_mix else "far")
        rows = rows.assign(link="as booked, " + rows["link"])
    many = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, again = received(many, rng), received(many, rng)
    four = (conceal(clean, drawn, seed), clean, simulated, conceal(again, drawn, seed))
    out = [rink.shown(_cut_out(one), listed=True) for one in four]
    if not drawn.listed:
        out = [one.drop(columns="obstacles", errors="ignore") for one in out]
    return Tables(out[0], out[1], out[2], out[3])


def _shifts(rng: np.random.Generator) -> pd.DataFrame:
    return rink.shifts(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _shifts(np.random.default_rng([855, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    record = Record(table, seed, np.random.default_rng([856, seed, len(table)]))
    skate(record, drawn.hidden, drawn.strength)
    out = record.written()
    return out if drawn.listed else out.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is written down: SAMPLES sizes from LEAD before the first path."""
    return rink.shown(_cut_out(table), listed=True)


def _cut_out(table: pd.DataFrame) -> pd.DataFrame:
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index) - LEAD, 0, WIDE_SAMPLES - SAMPLES).astype(np.intp)
    pairs = zip(table["cir_i"], table["cir_q"], begin, strict=True)
    sizes = [np.hypot(i, q)[at : at + SAMPLES].astype(np.float32) for i, q, at in pairs]
    out = table.drop(columns=["cir_i", "cir_q"])
    return out.assign(cir=sizes, first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the rink's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    crest = WIDE_LEAD + 0.5 + rng.random(size)
    symbols = 1015.0 - rng.poisson(9.0, size)
    sigma = 92.0 * np.exp(0.03 * rng.standard_normal(size))
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _in_the_hall(rows, crest, rng) + sigma[:, None] * crackle(rng, size)
    index = crests(cir, sigma)
    error = METRES * (index - crest - LATE) + 0.007 * rng.logistic(size=size)
    level, first = levels(cir, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=[*cir.real],
        cir_q=[*cir.imag],
    )


def _in_the_hall(rows: pd.DataFrame, crest: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by boards, by trusses, from stands."""
    size = len(rows)
    place, links = pd.factorize(rows["link"])
    steel = np.array([float("metal" in one) for one in rows["obstacles"]])
    straight = 1 - steel * rng.beta(3, 8, len(links))[place]
    cir = (straight * _any_phase(rng, size))[:, None] * bursts(crest)
    for late, share in _by_boards(rows):
        some = share * rng.weibull(1.6, len(links))[place]
        cir = cir + (some * _any_phase(rng, size))[:, None] * bursts(crest + late)
    for number in range(4):  # trusses stand every few metres
        late = (4.0 + 6.0 * number + rng.gamma(2.0, 2.0, len(links)))[place]
        share = 0.2 * 0.8**number * rng.beta(2, 2, len(links))[place]
        cir = cir + (share * _any_phase(rng, size))[:, None] * bursts(crest + late)
    since = INDEX - crest[:, None] - 3
    stands = rng.uniform(0.015, 0.035, len(links))[place, None] * np.exp(-np.abs(since) / 40)
    level = rink.over_ice(rows) + rng.normal(0, 1.2, len(links))[place] - 3.4
    rough = np.where(since > 0, stands, 0.0) * crackle(rng, size)
    return np.asarray(10 ** (level / 20)[:, None] * (cir + rough))


def _by_boards(rows: pd.DataFrame) -> list[tuple[Floats, Floats]]:
    """Return how many samples later the ways by both long boards come, and their shares."""
    far = rows["true_range_m"].to_numpy(np.float64)
    one, two = (rows[f"{end}_x_m"].to_numpy(np.float64) for end in ("tx", "rx"))
    out = []
    for plane in (0.0, RINK_M[0]):
        way = np.sqrt(far**2 - (one - two) ** 2 + (one + two - 2 * plane) ** 2)
        out.append((np.maximum((way - far) / METRES, 3.6), 0.3 * far / way))
    return out


def _any_phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
