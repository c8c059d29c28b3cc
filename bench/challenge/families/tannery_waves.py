"""The tannery's radio with its impulse responses: rows of `tannery`, drums and hides that return.

numpy and pandas alone; what can be hidden is in `tannery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import tannery
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.tannery_floor import DRUMS_M
from bench.challenge.families.tannery_reader import (
    METRES,
    OF_NOISE,
    PLACES,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Reading,
    murmur,
    rises,
    strengths,
    windows,
)
from bench.challenge.families.tannery_wave_effects import LAWS, OF_RANGES, WAVES, dye

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 13, 124
ROUNDS = (1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 5, 6)
FULL_DB = 110.0  # of levels
EARLY = 1.61  # samples by which clean pulses are timed before their tops, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in tannery.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the tannery's own."""
    rng = np.random.default_rng([seed, 895])
    rows = _hauls(rng)
    rows = rows if drawn.same_mix else tannery.of_one_end(rows, nearer=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = _hauls(rng)
        rows = rows if drawn.same_mix else tannery.of_one_end(rows, nearer=False)
        rows = rows.assign(link="of another week, " + rows["link"])
    often = tannery.over_again(rows, drawn.ratio)
    model, again = received(often, rng), received(often, rng)
    both = [_shown(one, drawn.listed) for one in (clean, model)]
    hidden = [_shown(_dyed(one, drawn, seed), drawn.listed) for one in (clean, again)]
    return Tables(hidden[0], both[0], both[1], hidden[1])


def _hauls(rng: np.random.Generator) -> pd.DataFrame:
    return tannery.hauls(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _hauls(np.random.default_rng([seed, 895]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    out = _dyed(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _dyed(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    reading = Reading(table, seed, np.random.default_rng([seed, len(table), 896]))
    dye(reading, drawn.hidden, drawn.strength)
    return reading.read()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is read out: SAMPLES sizes from LEAD before the first path."""
    return _shown(table, listed=True)


def _shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.trunc(index).astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    waves = np.array(table["cir_i"].tolist()) + 1j * np.array(table["cir_q"].tolist())
    part = np.lib.stride_tricks.sliding_window_view(np.abs(waves), SAMPLES, axis=1)
    sizes = part[np.arange(len(part)), begin].astype(np.float32)
    bare = tannery.told(table.drop(columns=["cir_i", "cir_q"]), listed)
    return bare.assign(cir=list(sizes), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the tannery's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + 1.0 + rng.random(size)
    symbols = 508.0 - rng.binomial(24, 0.3, size)
    sigma = 78.0 * (1 + 0.028 * rng.standard_normal(size))
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _in_the_shed(rows, top, rng) + sigma[:, None] * murmur(rng, size)
    index = rises(cir, sigma)
    error = METRES * (index - top + EARLY) + 0.024 * rng.triangular(-1, 0, 1, size)
    level, first = strengths(cir, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=list(cir.real),
        cir_q=list(cir.imag),
    )


def _in_the_shed(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by drums, by hides that hang about."""
    size, codes = len(rows), rows["link"].astype("category").cat.codes.to_numpy()
    links = int(codes.max()) + 1
    door = np.fromiter(("metal" in one for one in rows["obstacles"]), np.float64)
    straight = 1 - door * rng.triangular(0.1, 0.2, 0.45, links)[codes]
    cir = (straight * _chance(rng, size))[:, None] * windows(top)
    for late, share in _by_drums(rows):
        some = share * rng.uniform(0.3, 1.5, links)[codes]
        cir = cir + (some * _chance(rng, size))[:, None] * windows(top + late)
    for number in range(5):
        late = (4.2 + 4.5 * number + 6.0 * rng.beta(1.5, 2.5, links))[codes]
        share = 0.17 * 0.78**number * rng.gamma(3.0, 1 / 3.0, links)[codes]
        cir = cir + (share * _chance(rng, size))[:, None] * windows(top + late)
    since = PLACES - top[:, None] - 2.5
    haze = rng.triangular(0.012, 0.02, 0.04, links)[codes, None] / (1 + np.abs(since) / 25.0) ** 2
    level = tannery.below_the_roof(rows) + rng.logistic(0, 0.7, links)[codes] - 4.0
    rough = np.where(since > 0, haze, 0.0) * murmur(rng, size)
    return np.asarray(10 ** (level / 20)[:, None] * (cir + rough))


def _by_drums(rows: pd.DataFrame) -> list[tuple[Floats, Floats]]:
    """Return how many samples later the ways by the drums come, and their shares."""
    far = rows["true_range_m"].to_numpy(np.float64)
    one, two = (rows[[f"{end}_x_m", f"{end}_y_m"]].to_numpy(np.float64) for end in ("tx", "rx"))
    out = []
    for drum in DRUMS_M[::2]:
        legs = np.linalg.norm(one - drum, axis=1) + np.linalg.norm(two - drum, axis=1)
        out.append((np.clip((legs - far) / METRES, 3.8, 120.0), 0.22 * far / np.maximum(legs, far)))
    return out


def _chance(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, size)))
