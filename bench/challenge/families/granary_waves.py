"""The granary's sieves with their impulse responses: rows of `granary`, and what echoes.

numpy and pandas alone; what can be hidden is in `granary_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import granary
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.granary_bins import Docket
from bench.challenge.families.granary_harvest import harvested
from bench.challenge.families.granary_sieve import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Sieve,
    first_paths,
    levels_db,
    pouring,
    swells,
)
from bench.challenge.families.granary_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 148
OF_ROWS = np.repeat(np.arange(1, 9), [31, 28, 22, 15, 10, 7, 4, 2])
"""How many rows links have."""
FULL_DB = 117.4  # of levels: a count for each symbol
ECHOES, NEAREST, GAP = 26, 6.2, 3.0  # how many a link has; samples: the first, from one to the next
LATER_DB = 1.9  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in granary.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the granary's own."""
    rng = np.random.default_rng([seed, 3510])
    day = granary.thinned(harvested(rng, "", OF_ROWS), drawn, near=True)
    clean = received(day, rng)
    other = day
    if not drawn.paired:
        other = granary.another_day(harvested(rng, "", OF_ROWS), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_sifted(clean, drawn, seed, 1), clean, simulated, _sifted(anew, drawn, seed, 2))
    found, clean, simulated, truth = (_cut_out(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _sifted(table, drawn, seed, 20 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _sifted(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    sieve = Sieve(table, seed, np.random.default_rng([seed, 3511, side]))
    put_in(sieve, drawn.hidden, drawn.strength)
    return sieve.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut_out(table, True)


def _cut_out(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = at.astype(np.int64).clip(LEAD, WIDE_SAMPLES - SAMPLES + LEAD) - LEAD
    sizes = [np.hypot(*both) for both in zip(table["cir_i"], table["cir_q"], strict=True)]
    kept = [one[k : k + SAMPLES].astype(np.float32) for one, k in zip(sizes, begin, strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=kept, first_path_index=at - begin)
    return granary.as_shown(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return harvested(np.random.default_rng([seed, 3510]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that spouts' own sieves make of rows, with complex waveforms."""
    docket = Docket(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(docket.count)
    symbols, noise = granary.added_up(docket)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(docket, top) + sigma[:, None] * pouring(rng, docket.count)
    at = first_paths(wave, sigma)
    own = docket.per_link(lambda n: rng.triangular(-0.011, 0.0, 0.011, n))
    error = METRES * (at + AHEAD - top) + own + 0.01 * granary.chances(rng, docket.count)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, docket.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(granary.MEASURED, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _by_air(docket: Docket, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes come one after another, after gaps by chance; each is as large as chance has it, ever
    less by a power. Of what is behind lorries some comes straight.
    """
    link, rng = docket.per_link, docket.rng
    steel = docket.past("metal") * link(lambda n: 0.55 + 0.25 * rng.beta(1.2, 1.2, n))
    wave = _pulse(docket, top, 1 - steel)
    busy = link(lambda n: 0.32 + 0.64 * rng.beta(1.3, 2.4, n))
    after = np.full(docket.count, NEAREST - GAP)
    for _ in range(ECHOES):
        after = after + link(lambda n: GAP * (0.4 + 0.6 * rng.exponential(size=n)))
        after = np.maximum(after, NEAREST)
        loud = busy * (1 + after / 24.0) ** -1.5 * np.sqrt(rng.gamma(1.6, 1 / 1.6, docket.count))
        wave = wave + _pulse(docket, top + after, 0.85 * loud)
    level = granary.in_the_granary(docket) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(docket: Docket, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = np.exp(1j * docket.rng.uniform(0.0, 2 * np.pi, docket.count))
    return np.asarray((high * turn)[:, None] * swells(top))
