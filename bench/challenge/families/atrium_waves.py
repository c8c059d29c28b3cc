"""The atrium's radio with its impulse responses: rows of `atrium`, panes and galleries that echo.

numpy and pandas alone; what can be hidden is in `atrium_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import atrium
from bench.challenge.families.atrium_effects import by_glass_roof
from bench.challenge.families.atrium_unit import (
    AT,
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Unit,
    energies,
    halves,
    pulses,
    rustle,
)
from bench.challenge.families.atrium_wave_effects import LAWS, OF_RANGES, WAVES, go_through
from bench.challenge.families.atrium_well import STOREY_M, Ride
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 14, 138
OF_ROWS = np.repeat(np.arange(1, 7), [26, 24, 18, 15, 10, 7])  # how many rows links have
FULL_DB = 116.8  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in atrium.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the atrium's own."""
    rng = np.random.default_rng([1306, seed])
    rows = atrium.mixed(atrium.rides(rng, "", OF_ROWS), drawn, near=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = atrium.mixed(atrium.rides(rng, "", OF_ROWS), drawn, near=False)
        rows = rows.assign(link=[f"next day, {one}" for one in rows["link"]])
    many = rows.iloc[np.tile(np.arange(len(rows)), drawn.ratio)].reset_index(drop=True)
    simulated, other = received(many, rng), received(many, rng)
    found, truth = _through(clean, drawn, seed, 1), _through(other, drawn, seed, 2)
    kept = [_kept(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(kept[0], kept[1], kept[2], kept[3])


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return atrium.rides(np.random.default_rng([1306, seed]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _through(table, drawn, seed, len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _through(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    unit = Unit(table, seed, np.random.default_rng([1307, seed, side]))
    go_through(unit, drawn.hidden, drawn.strength)
    return unit.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    path = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(path).astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    real, imaginary = (np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q"))
    size = np.hypot(real, imaginary)
    kept = np.take_along_axis(size, begin[:, None] + np.arange(SAMPLES), axis=1)
    rows = atrium.shown(table, listed).drop(columns=["cir_i", "cir_q"])
    return rows.assign(cir=list(kept.astype(np.float32)), first_path_index=path - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the atrium's own radio makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.uniform(0.0, 1.0, len(rows))
    symbols, noise = atrium.added_up(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_court(rows, top, rng)
    wave = wave + sigma[:, None] * rustle(rng, len(rows))
    half = halves(wave, sigma)
    error = METRES * (half + RISE - top) + 0.0037 * rng.logistic(0.0, 1.0, len(rows))
    level, first = energies(wave, half, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=half,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _in_the_court(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by the roof, off galleries, and the rest.

    Galleries are one above the other, so that their edges are heard one after the other.
    """
    ride = Ride(rows, 0, rng)
    steel = 1 - ride.through("metal") * ride.by_link(lambda n: rng.triangular(0.5, 0.66, 0.8, n))
    roof = np.clip(by_glass_roof(ride) / METRES, 5.2, 120.0)
    wave = _one(rng, top, steel) + _one(rng, top + roof, _echo(ride, 0.2))
    late = ride.by_link(lambda n: rng.uniform(4.6, 7.5, n))
    for _ in range(9):
        wave += _one(rng, top + late, _echo(ride, 0.42) * np.exp(-late / 24.0))
        late = late + ride.by_link(lambda n: rng.gamma(1.5, 0.35 * STOREY_M / METRES, n))
    past = np.maximum(AT - top[:, None] - 2.8, 0.0)
    rest = ride.by_link(lambda n: rng.triangular(0.012, 0.025, 0.04, n))[:, None]
    wave += rest * np.exp(-((past / 34.0) ** 0.9)) * (past > 0) * rustle(rng, len(rows))
    level = atrium.across_the_court(rows, rng) - 4.1  # a pulse has more than its top
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _one(rng: np.random.Generator, top: Floats, size: Floats) -> Complexes:
    """Return a pulse for each row, at some phase [n, k]."""
    phase = np.exp(1j * rng.uniform(-np.pi, np.pi, len(top)))
    return np.asarray((size * phase)[:, None] * pulses(top))


def _echo(ride: Ride, usual: float) -> Floats:
    """Return how large an echo of each link is, next to what comes straight, [n]."""
    return ride.by_link(lambda n: usual * ride.rng.gamma(2.6, 1 / 2.6, n).clip(max=2.2))
