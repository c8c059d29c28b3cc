"""The chairlift's radio with its impulse responses: rows of `chairlift`, masts and trunks scatter.

numpy and pandas alone; what can be hidden is in `chairlift_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import chairlift
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.chairlift_effects import by_trees
from bench.challenge.families.chairlift_mast import (
    METRES,
    OF_SIZES,
    PEAK,
    SAMPLE_NS,
    SAMPLES_AT,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Mast,
    bumps,
    edges,
    murmur,
    powers,
)
from bench.challenge.families.chairlift_rope import PYLONS_M, Trip
from bench.challenge.families.chairlift_wave_effects import LAWS, OF_RANGES, WAVES, ail

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 20, 172
LENGTHS = {1: 27, 2: 25, 3: 20, 4: 15, 5: 10, 6: 7}
"""How many links have so many rows."""
FULL_DB = 118.5  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in chairlift.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the chairlift's own."""
    rng = np.random.default_rng([1220, seed, 1])
    here = chairlift.mixed(chairlift.trips(rng, "", LENGTHS), drawn, lower=True)
    clean = received(here, rng)
    there = here
    if not drawn.paired:
        there = chairlift.mixed(chairlift.trips(rng, "", LENGTHS), drawn, lower=False)
        there["link"] = "day after: " + there["link"]
    again = pd.concat([there] * drawn.ratio).reset_index(drop=True)
    simulated = received(again, rng)
    ailing = _ailing(clean, drawn, (seed, 0))
    truth = _ailing(received(again, rng), drawn, (seed, 1))
    four = [_public(one, drawn.listed) for one in (ailing, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3])


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return chairlift.trips(np.random.default_rng([1220, seed, 1]), "", LENGTHS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is public.
    """
    ailing = _ailing(table, drawn, (seed, len(table)))
    return ailing.drop(columns=[] if drawn.listed else ["obstacles"])


def _ailing(table: pd.DataFrame, drawn: Draw, seeds: tuple[int, int]) -> pd.DataFrame:
    mast = Mast(table, seeds[0], np.random.default_rng([1224, *seeds]))
    ail(mast, drawn.hidden, drawn.strength)
    return mast.reading()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is public: SAMPLES sizes from LEAD before the first path."""
    return _public(table, "obstacles" in table)


def _public(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = np.asarray(table["first_path_index"], np.float64)
    begin = np.clip(np.rint(index - 0.5) - LEAD, 0, WIDE_SAMPLES - SAMPLES).astype(np.int32)
    size = np.sqrt(sum(np.vstack([*table[name]]) ** 2 for name in ("cir_i", "cir_q")))
    seen = np.lib.stride_tricks.sliding_window_view(size, SAMPLES, axis=1)
    kept = seen[np.arange(len(size)), begin].astype(np.float32)
    out = table.assign(cir=[*kept], first_path_index=index - begin)
    return chairlift.public(out.drop(columns=["cir_i", "cir_q"]), listed)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the chairlift's own radio makes of rows, with complex waveforms."""
    peak = WIDE_LEAD + 1.2 + rng.random(len(rows))
    counts, noise = chairlift.taken(rows, rng)
    sigma = noise / OF_SIZES
    full = counts * 10 ** (FULL_DB / 20)
    wave = _up_a_slope(rows, peak, rng) * full[:, None] + murmur(rng, len(rows)) * sigma[:, None]
    edge = edges(wave, sigma)
    error = METRES * (edge + PEAK - peak) + 0.0055 * rng.laplace(0.0, 1.0, len(rows))
    level, first = powers(wave, edge, sigma) - 20 * np.log10(full)
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error)
    return out.assign(
        noise_std=noise,
        preamble_count=counts,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=edge + PEAK - 1.2,
        sample_period_ns=SAMPLE_NS,
        **{"cir_i": [*wave.real], "cir_q": [*wave.imag]},
    )


def _up_a_slope(rows: pd.DataFrame, peak: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by trees, off masts, and what is left."""
    trip = Trip(rows, 0, rng)
    steel = trip.meets("metal") * trip.for_links(lambda n: 0.3 + 0.4 * rng.beta(2.0, 2.0, n))
    wave = (1 - steel)[:, None] * bumps(peak) * _spin(rng, len(rows))
    for late, by in (*_by_masts(trip), *_by_things(trip)):
        wave = wave + by[:, None] * bumps(peak + late) * _spin(rng, len(rows))
    past = SAMPLES_AT - peak[:, None] - 3.2
    grain = trip.for_links(lambda n: rng.gamma(4.0, 0.006, n))[:, None]
    wave = wave + np.where(past > 0, grain / (1 + np.abs(past) / 30.0), 0.0) * murmur(
        rng, len(rows)
    )
    level = chairlift.up_the_line(rows, rng) - 4.6  # a pulse has more than its peak
    return np.asarray(np.power(10.0, level / 20)[:, None] * wave)


def _by_masts(trip: Trip) -> list[tuple[Floats, Floats]]:
    """Return how late ways by the three masts nearest to them are in samples, and how large."""
    legs = [np.linalg.norm(end[:, None] - PYLONS_M, axis=2) for end in (trip.seat, trip.mast)]
    longer = np.sort((legs[0] + legs[1] - trip.long[:, None]) / METRES, axis=1)
    made = []
    for k in (2, 3, 4):  # those before are its own mast, or in the way
        glint = trip.for_links(lambda n: trip.rng.uniform(0.05, 0.3, n))
        made.append((longer[:, k].clip(5.0, 140.0), glint))
    return made


def _by_things(trip: Trip) -> list[tuple[Floats, Floats]]:
    """Return how late ways by trees and by chairs that pass are in samples, and how large."""
    made = [(by_trees(trip).clip(2.0, 40.0) / METRES, 0.12 + 0 * trip.long)]
    for _ in range(6):
        late = trip.for_links(lambda n: 4.9 + trip.rng.lognormal(2.0, 0.8, n).clip(max=70.0))
        size = trip.for_links(lambda n: trip.rng.rayleigh(0.21, n).clip(max=0.5))
        made.append((late, size * np.exp(-late / 40.0)))
    return made


def _spin(rng: np.random.Generator, size: int) -> Complexes:
    """Return phases [n, 1]."""
    return np.asarray(np.exp(1j * rng.uniform(0.0, 2 * np.pi, (size, 1))))
