"""The quarry's radio with its impulse responses: rows of `quarry`, faces of rock that return.

numpy and pandas alone; what can be hidden is in `quarry_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import quarry
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.quarry_log import (
    METRES,
    OF_NOISE,
    PLACES,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Log,
    blasts,
    energies,
    hiss,
    tops,
)
from bench.challenge.families.quarry_pit import FACE_Y_M
from bench.challenge.families.quarry_wave_effects import LAWS, OF_RANGES, WAVES, loaded

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 144
ROUNDS = (1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 6, 7, 9)
FULL_DB = 121.0  # of levels
LATE = 0.136  # samples by which clean tops come after pulses', by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in quarry.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the quarry's own."""
    rng = np.random.default_rng([835, seed])
    rows = quarry.quarried(_spells(rng), "both" if drawn.same_mix else "floor")
    clean = received(rows, rng)
    if not drawn.paired:
        rows = quarry.quarried(_spells(rng), "both" if drawn.same_mix else "rim")
        rows["link"] = "as drafted: " + rows["link"].astype(str)
    often = pd.concat([rows for _ in range(drawn.ratio)]).reset_index(drop=True)
    model, true = received(often, rng), received(often, rng)
    four = (conceal(clean, drawn, seed), clean, model, conceal(true, drawn, seed))
    found, plain, drafted, truth = (quarry.published(_shown(one), drawn.listed) for one in four)
    return Tables(found, plain, drafted, truth)


def _spells(rng: np.random.Generator) -> pd.DataFrame:
    return quarry.spells(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _spells(np.random.default_rng([835, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    log = Log(table, seed, np.random.default_rng([836, len(table), seed]))
    loaded(log, drawn.hidden, drawn.strength)
    out = log.logged()
    return out if drawn.listed else out.drop(columns=["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES sizes from LEAD before the first path."""
    return quarry.published(_shown(table), listed=True)


def _shown(table: pd.DataFrame) -> pd.DataFrame:
    index = np.array(table["first_path_index"], np.float64)
    begin = np.clip(index.astype(int) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    waves = np.array([*table["cir_i"]], np.float64) + 1j * np.array([*table["cir_q"]], np.float64)
    parts = begin[:, None] + np.arange(SAMPLES)[None, :]
    sizes = np.abs(np.take_along_axis(waves, parts, axis=1)).astype(np.float32)
    out = table.drop(columns=["cir_i", "cir_q"])
    return out.assign(cir=[*sizes], first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the quarry's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    place = WIDE_LEAD + 3 + rng.random(size)
    symbols = 124.0 - rng.binomial(9, 0.25, size)
    sigma = 39.0 + 1.3 * rng.normal(size=size)
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _in_the_pit(rows, place, rng) + sigma[:, None] * hiss(rng, size)
    index = tops(cir, sigma)
    error = METRES * (index - place - LATE) + 0.0105 * rng.standard_t(9.0, size)
    level, first = energies(cir, index) - 20 * np.log10(full)
    made = rows.assign(error_m=error, range_m=rows["true_range_m"] + error)
    made = made.assign(rx_power_dbm=level, first_path_power_dbm=first, first_path_index=index)
    made["sample_period_ns"] = 1.0016
    made["noise_std"], made["preamble_count"] = OF_NOISE * sigma, symbols
    return made.assign(cir_i=[*cir.real], cir_q=[*cir.imag])


def _in_the_pit(rows: pd.DataFrame, place: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW: straight, by the face, by heaps about, from loose rock."""
    size = len(rows)
    number, links = rows["link"].factorize()
    skip = np.array([1.0 if "metal" in row else 0.0 for row in rows["obstacles"]])
    straight = 1 - skip * rng.triangular(0.1, 0.25, 0.4, links.size)[number]
    cir = (straight * _spins(rng, size))[:, None] * blasts(place)
    late, share = _by_the_face(rows)
    cir = cir + (share * rng.rayleigh(0.8, links.size)[number] * _spins(rng, size))[
        :, None
    ] * blasts(place + late)
    for begin in (2.5, 9.0, 17.0, 30.0):  # heaps of rock stand anywhere
        late = (3.6 + rng.exponential(begin, links.size))[number]
        share = 0.27 * rng.beta(2, 3, links.size)[number]
        cir = cir + (share * _spins(rng, size))[:, None] * blasts(place + late)
    since = np.maximum(PLACES - place[:, None] - 2.5, 0)
    loose = rng.uniform(0.012, 0.03, links.size)[number, None] / (1 + since / 18) ** 1.5
    level = quarry.over_rock(rows) + rng.uniform(-1.6, 1.6, links.size)[number] - 5.4
    return np.asarray(10 ** (level / 20)[:, None] * (cir + loose * (since > 0) * hiss(rng, size)))


def _by_the_face(rows: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return how many samples later the way by the upper face comes, and its share, [n] each."""
    far = rows["true_range_m"].to_numpy(np.float64)
    ends = (FACE_Y_M - rows[f"{end}_y_m"].to_numpy(np.float64) for end in ("tx", "rx"))
    across = (rows["tx_y_m"] - rows["rx_y_m"]).to_numpy(np.float64)
    way = np.sqrt(far**2 - across**2 + np.square(sum(ends)))
    return np.maximum((way - far) / METRES, 3.5), 0.36 * far / way


def _spins(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
