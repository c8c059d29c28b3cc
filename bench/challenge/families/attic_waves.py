"""The attic's radio with its impulse responses: rows of `attic`, and a receiver of its own.

numpy and pandas alone; what can be hidden is in `attic_wave_effects`. No temperature is logged.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import attic
from bench.challenge.families.attic_receiver import (
    RICE,
    STEP_M,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Reception,
    found_at,
    levels_of,
    pulse,
)
from bench.challenge.families.attic_wave_effects import LAWS, OF_RANGES, WAVES, befall
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 11, 118
CRAWLS, ROUNDS = 14, 2
UNIT_DB = 113.77  # of levels, at a pulse repetition of 16 MHz
KNOWN = tuple(sorted({*OF_RANGES, *WAVES} - {*LAWS}))
CAUSES = {name: attic.CAUSES[name] for name in OF_RANGES if name in attic.CAUSES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the attic's own."""
    rng = np.random.default_rng([521, seed])
    clean = received(attic.part_of(_crawled(rng), "" if drawn.same_mix else "near"), rng)
    rows = clean
    if not drawn.paired:
        rows = attic.part_of(_crawled(rng), "" if drawn.same_mix else "far")
        rows["link"] = "sketch of " + rows["link"]
    drawn_twice = []
    for _ in range(2):
        parts = [received(rows, rng) for _ in range(drawn.ratio)]
        drawn_twice.append(pd.concat(parts, ignore_index=True))
    simulated, again = drawn_twice
    found, truth = conceal(clean, drawn, seed), conceal(again, drawn, seed)
    found, clean, simulated, truth = (
        attic.public(recorded(one), drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(found, clean, simulated, truth)


def _crawled(rng: np.random.Generator) -> pd.DataFrame:
    return attic.crawled(rng, "", ROUNDS, CRAWLS).drop(columns="temperature_c")


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _crawled(np.random.default_rng([521, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    reception = Reception(table, seed, [522, len(table), seed])
    befall(reception, drawn.hidden, drawn.strength)
    noted = reception.noted()
    return noted if drawn.listed else noted.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES magnitudes from LEAD before the first path."""
    parts = np.stack([np.stack([*table[name]]) for name in ("cir_i", "cir_q")])
    whole = np.sqrt((parts**2).sum(axis=0)).astype(np.float32)
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(int) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    shown = [row[at : at + SAMPLES] for row, at in zip(whole, begin, strict=True)]
    out = attic.public(table.drop(columns=["cir_i", "cir_q"]), listed=True)
    out["cir"], out["first_path_index"] = pd.Series(shown, index=out.index), index - begin
    return out


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the attic's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    start, symbols = WIDE_LEAD + 1 + rng.random(size), 256.0 - rng.geometric(0.4, size)
    sigma = rng.uniform(112.0, 124.0, size)
    waves = _ways(rows, start, rng) * (symbols * 10 ** (UNIT_DB / 20))[:, None]
    waves = waves + sigma[:, None] * (rng.normal(size=(2, *waves.shape)).T @ [1, 1j]).T
    index = np.floor(found_at(waves, sigma) * 64) / 64
    out = rows.assign(noise_std=sigma / RICE, preamble_count=symbols, sample_period_ns=1.0016)
    out["first_path_index"] = index
    out["error_m"] = STEP_M * (index - start + 0.51) + rng.normal(0, 0.011, size)
    out["range_m"] = out["true_range_m"] + out["error_m"]
    levels = levels_of(waves, index) - 20 * np.log10(symbols) - UNIT_DB
    out["rx_power_dbm"], out["first_path_power_dbm"] = levels
    return out.assign(cir_i=[*waves.real], cir_q=[*waves.imag])


def _ways(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is received in root mW: straight, off rafters, and what the attic keeps."""
    far, size = rows["true_range_m"].to_numpy(np.float64), len(rows)
    which, links = pd.factorize(rows["link"])
    level = -63.5 - 16.4 * np.log10(far) - rng.gamma(2.2, 0.6, len(links))[which]
    tank = np.array(["metal" in row for row in rows["obstacles"]])
    straight = np.where(tank, 10 ** (-rng.triangular(5, 9, 14, size) / 20), 1.0)
    waves = (straight * _phases(rng, size))[:, None] * pulse(start)
    for rafter in range(1, 7):
        late = (1.7 + rafter * 2.6 * rng.lognormal(0, 0.3, len(links)))[which]
        weak = 0.2 * 0.85**rafter * rng.rayleigh(0.8, len(links))[which] * _phases(rng, size)
        waves = waves + weak[:, None] * pulse(start + late)
    after = np.arange(WIDE_SAMPLES) - start[:, None]
    kept = 0.045 * np.exp(-np.maximum(after, 0) / 30) * np.clip((after - 1) / 5, 0, 1)
    rough = kept * (rng.normal(size=(2, *after.shape)).T @ [1, 1j]).T
    return np.asarray(10 ** (level / 20)[:, None] / 1.4 * (waves + rough))


def _phases(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(0, 2 * np.pi, size)))
