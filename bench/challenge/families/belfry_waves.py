"""The belfry's radio with its impulse responses: rows of `belfry`, headstones that return.

numpy and pandas alone; what can be hidden is in `belfry_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import belfry
from bench.challenge.families.belfry_close import HEADSTONES_M
from bench.challenge.families.belfry_ear import (
    BEAT,
    METRES,
    OF_NOISE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Heard,
    attacks,
    loudness,
    rustle,
    strokes,
)
from bench.challenge.families.belfry_wave_effects import LAWS, OF_RANGES, WAVES, ring
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 14, 130
ROUNDS = (1, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 5, 5)
FULL_DB = 111.0  # of levels
EARLY = 1.144  # samples by which clean pulses rise fastest before their tops, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in belfry.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the belfry's own."""
    rng = np.random.default_rng([seed, 945])
    rows = belfry.drawn_up(rng, drawn, True, ROUNDS)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = belfry.drawn_up(rng, drawn, False, ROUNDS)
        rows = rows.assign(link="in another parish " + rows["link"])
    many = pd.concat([rows for _ in range(drawn.ratio)], ignore_index=True)
    model, truth = received(many, rng), received(many, rng)
    every = (_rung(clean, drawn, seed), clean, model, _rung(truth, drawn, seed))
    made = [_public(one, drawn.listed) for one in every]
    return Tables(made[0], made[1], made[2], made[3])


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return belfry.visits(np.random.default_rng([seed, 945]), "", ROUNDS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    out = _rung(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _rung(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    heard = Heard(table, seed, np.random.default_rng([seed, len(table), 946]))
    ring(heard, drawn.hidden, drawn.strength)
    return heard.said()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is published: SAMPLES sizes from LEAD before the first path."""
    return _public(table, listed=True)


def _public(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    skipped = np.clip(np.floor(index) - LEAD, 0, WIDE_SAMPLES - SAMPLES).astype(np.intp)
    both = (np.array(table[name].to_list()) for name in ("cir_i", "cir_q"))
    sizes = np.sqrt(sum(np.square(part) for part in both))
    kept = sizes[np.arange(len(sizes))[:, None], skipped[:, None] + np.arange(SAMPLES)]
    bare = belfry.in_public(table.drop(columns=["cir_i", "cir_q"]), listed)
    return bare.assign(cir=[*kept.astype(np.float32)], first_path_index=index - skipped)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the belfry's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + 1.5 + rng.random(size)
    symbols = 1010.0 - np.floor(rng.exponential(8.0, size))
    sigma = 90.0 + rng.logistic(0.0, 1.6, size)
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _in_the_close(rows, top, rng) + sigma[:, None] * rustle(rng, size)
    index = attacks(cir, sigma)
    error = METRES * (index - top + EARLY) + 0.018 * (rng.random((3, size)).sum(axis=0) - 1.5)
    level, first = loudness(cir, index, sigma) - 20 * np.log10(full)
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


def _in_the_close(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by headstones, by yews, by the rest."""
    size, link = len(rows), pd.factorize(rows["link"])[0]
    links = link.max() + 1
    iron = rows["obstacles"].map(lambda some: "metal" in some).to_numpy(np.float64)
    straight = 1 - iron * rng.triangular(0.08, 0.2, 0.42, links)[link]
    cir = (straight * _any_phase(rng, size))[:, None] * strokes(top)
    for late, spread in _by_headstones(rows):
        share = spread * rng.gamma(2.0, 0.5, links)[link]
        cir = cir + (share * _any_phase(rng, size))[:, None] * strokes(top + late)
    for _ in range(3):  # yews, here and there
        late, share = rng.uniform(5.0, 48.0, links), 0.11 * rng.lognormal(-0.2, 0.5, links)
        cir = cir + (share[link] * _any_phase(rng, size))[:, None] * strokes(top + late[link])
    past = np.maximum(BEAT - top[:, None] - 2.0, 0)
    rest = rng.uniform(0.008, 0.022, links)[link, None] * np.exp(-((past / 40.0) ** 1.5))
    level = belfry.about_the_tower(rows) + rng.gumbel(-0.5, 0.9, links)[link] - 4.6
    whole = cir + (past > 0) * rest * rustle(rng, size)
    return np.asarray(10 ** (level / 20)[:, None] * whole)


def _by_headstones(rows: pd.DataFrame) -> list[tuple[Floats, Floats]]:
    """Return how many samples later the ways by headstones come, and their shares.

    By the radar equation for two places: far by the product of both legs.
    """
    far = rows["true_range_m"].to_numpy(np.float64)
    ends = [rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx")]
    out = []
    for stone in HEADSTONES_M:
        place = np.array([*stone, 0.7])
        one, two = (np.linalg.norm(end - place, axis=1).clip(1.5) for end in ends)
        share = np.minimum(1.35 * far / (one * two), 0.3)
        out.append((np.clip((one + two - far) / METRES, 4.0, 125.0), share))
    return out


def _any_phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, size)))
