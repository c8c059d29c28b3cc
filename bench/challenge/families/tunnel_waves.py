"""The tunnel's radio with its impulse responses: rows of `tunnel`, a channel of mirrored bores.

numpy and pandas alone; what can be hidden is in `tunnel_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import tunnel
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.tunnel_effects import BORE_M
from bench.challenge.families.tunnel_probe import (
    EARLIER,
    SAMPLE_M,
    SPREAD_OF_SIZE,
    STANDS_OUT,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Probe,
    decibels,
    first_maximum,
    responses,
)
from bench.challenge.families.tunnel_wave_effects import LAWS, OF_RANGES, WAVES, pass_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 14, 134
LAPS = 2
UNIT_DB = 113.77  # of levels, at a pulse repetition of 16 MHz
BOUNCES = (  # factor and shift in widths or heights of the image in y and z, and what is left
    ((-1, 0), (1, 0), 0.4), ((-1, 2), (1, 0), 0.4), ((1, 2), (1, 0), 0.2), ((1, -2), (1, 0), 0.2),
    ((1, 0), (-1, 2), 0.2), ((1, 0), (-1, 0), 0.1), ((-1, 0), (-1, 2), 0.15),
)  # fmt: skip
KNOWN = tuple(sorted({*OF_RANGES, *WAVES} - {*LAWS}))
CAUSES = {name: cause for name, cause in tunnel.CAUSES.items() if name in {*OF_RANGES, *LAWS}}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the tunnel's own."""
    rng = np.random.default_rng([621, seed])
    rows = tunnel.one_mix(_rows(rng), drawn.same_mix, short=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = tunnel.one_mix(_rows(rng), drawn.same_mix, short=False)
        rows["link"] = rows["link"] + " as planned"
    simulated = pd.concat([received(rows, rng) for _ in range(drawn.ratio)], ignore_index=True)
    again = pd.concat([received(rows, rng) for _ in range(drawn.ratio)], ignore_index=True)
    made = (conceal(clean, drawn, seed), clean, simulated, conceal(again, drawn, seed))
    found, clean, simulated, truth = (tunnel.shown(recorded(one), drawn.listed) for one in made)
    return Tables(found, clean, simulated, truth)


def _rows(rng: np.random.Generator) -> pd.DataFrame:
    return tunnel.driven(rng, "", LAPS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _rows(np.random.default_rng([621, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    probe = Probe(table, seed, np.random.default_rng([622, seed, len(table)]))
    pass_through(probe, drawn.hidden, drawn.strength)
    return probe.notes().drop(columns=[] if drawn.listed else ["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES magnitudes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    shown = [
        np.hypot(real[b : b + SAMPLES], imaginary[b : b + SAMPLES]).astype(np.float32)
        for real, imaginary, b in zip(table["cir_i"], table["cir_q"], begin, strict=True)
    ]
    kept = tunnel.shown(table, listed=True).drop(columns=["cir_i", "cir_q"])
    return kept.assign(cir=pd.Series(shown, index=kept.index), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the tunnel's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    start, symbols = WIDE_LEAD + 1 + rng.random(size), 128.0 - rng.integers(0, 5, size)
    sigma = 29.0 * rng.lognormal(0, 0.05, size)
    waves = _channel(rows, start, rng) * (symbols * 10 ** (UNIT_DB / 20))[:, None]
    noise = rng.standard_normal((2, *waves.shape))
    waves = waves + sigma[:, None] * (noise[0] + 1j * noise[1])
    index = np.rint(first_maximum(waves, STANDS_OUT * sigma) * 128) / 128
    error = SAMPLE_M * (index - start) + rng.normal(0, 0.015, size)
    per_symbol = 20 * np.log10(symbols) + UNIT_DB
    levels = {name: value - per_symbol for name, value in decibels(waves, index).items()}
    return rows.assign(
        range_m=rows["true_range_m"] + error, error_m=error, first_path_index=index,
        noise_std=SPREAD_OF_SIZE * sigma, preamble_count=symbols, sample_period_ns=1.0016,
        channel=3, prf_mhz=16.0, cir_i=list(waves.real), cir_q=list(waves.imag), **levels,
    )  # fmt: skip


def _channel(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what arrives in root mW: straight, by walls and roof, and from all the lining."""
    code, links = pd.factorize(rows["link"])
    away = rows["true_range_m"].to_numpy(np.float64)
    wagon = np.array(["metal" in row for row in rows["obstacles"]])
    straight = np.where(wagon, 10 ** (-rng.uniform(5, 12, len(links))[code] / 20), 1.0)
    waves = (straight * _phase(rng, len(rows)))[:, None] * responses(start + EARLIER)
    for image_y, image_z, left in BOUNCES:
        way = _mirrored(rows, image_y, image_z)
        size = left * rng.weibull(2.2, len(links))[code] * away / way * _phase(rng, len(rows))
        size = size * np.minimum((way - away) / 1.3, 1)  # niches do not look along their wall
        waves = waves + size[:, None] * responses(start + EARLIER + (way - away) / SAMPLE_M)
    since = np.arange(WIDE_SAMPLES) - start[:, None] - 3
    lining = 0.03 * np.exp(-np.maximum(since, 0) / 44) * (since > 0)
    rough = rng.standard_normal((2, *lining.shape)) * lining
    level = tunnel.guided(away) - 2.0 + rng.uniform(-2, 2, len(links))[code]
    return np.asarray(10 ** (level / 20)[:, None] / 1.25 * (waves + rough[0] + 1j * rough[1]))


def _mirrored(rows: pd.DataFrame, image_y: tuple[int, int], image_z: tuple[int, int]) -> Floats:
    """Return the ways between receivers and images of transmitters in m [n]."""
    tx, rx = (rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx"))
    scale = np.array([1, image_y[0], image_z[0]])
    shift = np.array([0, image_y[1] * BORE_M[1], image_z[1] * BORE_M[2]])
    return np.asarray(np.linalg.norm(tx * scale + shift - rx, axis=1))


def _phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
