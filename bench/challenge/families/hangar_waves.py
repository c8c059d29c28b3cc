"""The hangar's radio with its impulse responses: rows of `hangar`, walls and wings that echo.

numpy and pandas alone; what can be hidden is in `hangar_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import hangar
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.hangar_bay import Job
from bench.challenge.families.hangar_effects import by_shiny
from bench.challenge.families.hangar_radio import (
    AT,
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Radio,
    half_rises,
    pulses,
    read_levels,
    rustle,
)
from bench.challenge.families.hangar_wave_effects import LAWS, OF_RANGES, WAVES, send_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 132
OF_LINKS = (27, 25, 19, 15, 11, 8)  # how many links have one row, two rows and so on
FULL_DB = 116.0  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in hangar.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the hangar's own."""
    rng = np.random.default_rng([seed, 1315])
    rows = hangar.thinned(hangar.jobs(rng, "", OF_LINKS), drawn, near=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = hangar.thinned(hangar.jobs(rng, "", OF_LINKS), drawn, near=False)
        rows = rows.assign(link="other day, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, other = received(more, rng), received(more, rng)
    found, true = _with_hidden(clean, drawn, seed, 0), _with_hidden(other, drawn, seed, 1)
    four = (found, clean, simulated, true)
    found, clean, simulated, true = (_kept(table, drawn.listed) for table in four)
    return Tables(found, clean, simulated, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return hangar.jobs(np.random.default_rng([seed, 1315]), "", OF_LINKS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _with_hidden(table, drawn, seed, len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _with_hidden(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    radio = Radio(table, seed, np.random.default_rng([1316, seed, side]))
    send_through(radio, drawn.hidden, drawn.strength)
    return radio.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    path = table["first_path_index"].to_numpy(np.float64)
    begin = np.floor(path - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    parts = zip(table["cir_i"], table["cir_q"], begin, strict=True)
    sizes = [
        np.hypot(i[at : at + SAMPLES], q[at : at + SAMPLES]).astype(np.float32)
        for i, q, at in parts
    ]
    rows = hangar.as_told(table, listed).drop(columns=["cir_i", "cir_q"])
    return rows.assign(cir=sizes, first_path_index=path - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the hangar's own radio makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    sums, noise = hangar.accumulated(rows, rng)
    sigma, full = noise / OF_SIZES, sums * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _among_aircraft(rows, top, rng)
    wave = wave + sigma[:, None] * rustle(rng, len(rows))
    path = half_rises(wave, sigma)
    error = METRES * (path + RISE - top) + 0.007 * rng.standard_t(7.0, len(rows))
    level, first = read_levels(wave, path, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=path,
        sample_period_ns=np.full(len(rows), SAMPLE_NS),
        noise_std=noise,
        preamble_count=sums,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _among_aircraft(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off engines, and by chance off others."""
    job = Job(rows, 0, rng)
    shaded = 1 - job.through("metal") * job.by_links(lambda n: rng.uniform(0.5, 0.8, n))
    engines = (by_shiny(job) / METRES).clip(5.2, 120.0)
    rays = [(0.0 * top, shaded), (engines, _glimmer(job, 0.34))]
    late = 4.8 + job.by_links(lambda n: rng.exponential(2.0, n))
    for _ in range(9):
        rays.append((late, _glimmer(job, 0.4) * np.exp(-late / 26.0)))
        late = late + job.by_links(lambda n: rng.gamma(1.4, 3.1, n))
    wave = np.zeros((len(rows), WIDE_SAMPLES), np.complex128)
    for samples, size in rays:
        phase = np.exp(2j * np.pi * rng.random(len(rows)))
        wave += (size * phase)[:, None] * pulses(top + samples)
    since = np.maximum(AT - top[:, None] - 3.5, 0.0)
    rest = job.by_links(lambda n: rng.uniform(0.012, 0.035, n))[:, None] * np.exp(-since / 32.0)
    wave += rest * (since > 0) * rustle(rng, len(rows))
    level = hangar.levels(rows, rng) - 3.9  # a pulse has more than its top
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _glimmer(job: Job, usual: float) -> Floats:
    """Return how large an echo of each link is, next to what comes straight, [n]."""
    return job.by_links(lambda n: usual * job.rng.rayleigh(0.75, n).clip(max=1.9))
