"""A theatre: performers with tags below rigs with receivers, as channel impulse responses.

numpy and pandas alone; what it can hide is in `stage_effects`. Its own simulator: a pulse of a
gamma law, mirrored faces, a tail that falls as a power, a receiver that seeks the steepest rise.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.stage_effects import (
    EFFECTS,
    LAST,
    LAWS,
    QUIET,
    RIGS,
    SAMPLE_M,
    SCENERY,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Take,
    seen,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
ROOMS_M = ((8.5, 6.0, 3.4), (14.0, 10.5, 6.5))  # where they rehearse, and the stage
LINKS, MOST_ROWS = 110, 2
LEAD, SAMPLES = 9, 150  # of the impulse responses that are shown
GAIN, NOISE, SCATTER_M = 30000.0, 42.0, 0.016
RISE, FULL_DB = 2.15, 151.0  # samples from a pulse's onset to its top; of counts squared at 0 dBm
SYMBOLS = 1024.0
CAUSES: dict[str, str] = {}
RARELY = ()
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the stage's own."""
    rng = np.random.default_rng([seed, 51])
    rows = _placed(rng, 0.5 if drawn.same_mix else 0.75)
    clean = _played(rows, [seed, 52])
    found = conceal(clean, drawn, seed)
    if not drawn.paired:
        rows = _placed(rng, 0.5 if drawn.same_mix else 0.25)
        rows = rows.assign(link="model " + rows["link"])
    more, again = (
        pd.concat([_played(rows, [seed, part, n]) for n in range(drawn.ratio)], ignore_index=True)
        for part in (53, 54)
    )
    gone = [] if drawn.listed else ["obstacles"]
    truth = conceal(again, drawn, seed + 1, seed)
    found, clean, more, truth = (
        recorded(one).drop(columns=gone, errors="ignore") for one in (found, clean, more, truth)
    )
    return Tables(found, clean, more, truth)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _placed(np.random.default_rng([seed, 51]), 0.5)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int, own: int | None = None) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown. `own`:
    the seed of what devices keep, `seed` itself unless given.
    """
    rng = np.random.default_rng([seed, 55, len(table)])
    take = Take.of(table, seed if own is None else own, rng)
    for name in sorted(drawn.hidden, key=lambda one: one in LAST and 1 + LAST.index(one)):
        EFFECTS[name](take, drawn.strength)
    return _reported(table, take).drop(columns=[] if drawn.listed else ["obstacles"])


def _reported(table: pd.DataFrame, take: Take) -> pd.DataFrame:
    """Return the table with changed samples, and all that is reported moved by what they say."""
    later, louder_db, early_db = take.moved
    longer_m = SAMPLE_M * later + take.late_m
    return table.assign(
        cir_i=list(take.cir.real),
        cir_q=list(take.cir.imag),
        noise_std=take.hiss,
        preamble_count=take.symbols,
        first_path_index=table["first_path_index"] + later + take.miscounted,
        range_m=table["range_m"] + longer_m,
        error_m=table["error_m"] + longer_m,
        rx_power_dbm=table["rx_power_dbm"] + louder_db,
        first_path_power_dbm=table["first_path_power_dbm"] + early_db,
    )


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as a radio would log it: SAMPLES magnitudes from LEAD before the path."""
    begin = np.floor(table["first_path_index"].to_numpy(np.float64)).astype(int) - LEAD
    begin = np.clip(begin, 0, WIDE_SAMPLES - SAMPLES)
    real, imaginary = (np.stack(list(table[name])) for name in ("cir_i", "cir_q"))
    shown = begin[:, None] + np.arange(SAMPLES)
    size = np.take_along_axis(np.hypot(real, imaginary), shown, axis=1).astype(np.float32)
    return table.drop(columns=["cir_i", "cir_q"]).assign(
        cir=list(size), first_path_index=table["first_path_index"] - begin
    )


def _placed(rng: np.random.Generator, share: float) -> pd.DataFrame:
    """Return what is known of the rows: performers anywhere, a `share` of them in rehearsal."""
    room = np.array(ROOMS_M)[(rng.random(LINKS) >= share).astype(int)]
    rig = rng.integers(0, len(RIGS), LINKS)
    ends = {
        "tx": rng.uniform(
            [0.4, 0.4, 0.8], np.column_stack([room[:, :2] - 0.4, np.full(LINKS, 1.9)])
        ),
        "rx": room * np.array(RIGS)[rig],
        "room": room,
    }
    rows = np.repeat(np.arange(LINKS), rng.integers(1, MOST_ROWS + 1, LINKS))
    places = {
        f"{end}_{axis}_m": at[rows, place]
        for end, at in ends.items()
        for place, axis in enumerate("xyz")
    }
    kinds = rng.choice(["", *SCENERY, "metal"], LINKS, p=[0.48, 0.18, 0.18, 0.16])
    frame = pd.DataFrame({"link": [f"s{row}" for row in rows], **places})
    return frame.assign(
        tx=[f"mime{row % 3}" for row in rows],
        rx=[f"rig{rig[row]}" for row in rows],
        time_s=np.arange(len(rows)) * 1.5,
        true_range_m=np.linalg.norm(ends["tx"] - ends["rx"], axis=1)[rows],
        obstacles=pd.Series([[kinds[row]] if kinds[row] else [] for row in rows], dtype=object),
    )


def _played(rows: pd.DataFrame, seed: list[int]) -> pd.DataFrame:
    """Return the table with the complex samples, ranges and levels of the stage's own radio."""
    rng, count = np.random.default_rng(seed), len(rows)
    start = WIDE_LEAD + rng.random(count)
    cir = _sum(start, *_faces(rows, rng)) + _seats(rows, start, rng)
    floor = np.full(count, 2 * NOISE**2)
    cir = cir + NOISE * (rng.normal(size=cir.shape) + 1j * rng.normal(size=cir.shape))
    first, energy, early = seen(cir, floor)
    error = SAMPLE_M * (first - start) + rng.normal(0, SCATTER_M, count)
    return rows.assign(
        range_m=rows["true_range_m"] + error,
        error_m=error,
        rx_power_dbm=10 * np.log10(energy) - FULL_DB,
        first_path_power_dbm=10 * np.log10(early) - FULL_DB,
        noise_std=np.abs(cir[:, :QUIET]).std(axis=1),
        preamble_count=SYMBOLS,
        first_path_index=first,
        sample_period_ns=1.0016,
        cir_i=list(cir.real),
        cir_q=list(cir.imag),
    )


def _faces(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Complexes]:
    """Return excess in samples and gain [n, 7]: the straight line, and six mirrored ones."""
    tx, rx, room = (
        rows[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)
        for end in ("tx", "rx", "room")
    )
    codes, links = pd.factorize(rows["link"])
    shade = rng.normal(0, 1.2, len(links))[codes]
    ways = [np.linalg.norm(tx - rx, axis=1)]
    gains = [np.exp(2j * np.pi * rng.random(len(rows))) * 10 ** (-shade / 20) / ways[0]]
    for axis in range(3):
        for wall in (np.zeros(len(rows)), room[:, axis]):
            image = tx.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            ways.append(np.linalg.norm(image - rx, axis=1))
            turn = np.exp(2j * np.pi * rng.random(len(rows)))
            gains.append(turn * rng.uniform(0.1, 0.3, len(rows)) / ways[-1])
    longer = (np.stack(ways, axis=1) - ways[0][:, None]) / SAMPLE_M
    return longer, np.asarray(GAIN * np.stack(gains, axis=1), np.complex128)


def _sum(start: Floats, longer: Floats, gain: Complexes) -> Complexes:
    """Return the sum of pulses [n, WIDE_SAMPLES]: of a gamma law, steepest where each begins."""
    total = np.zeros((len(start), WIDE_SAMPLES), complex)
    for late, size in zip(longer.T, gain.T, strict=True):
        since = (np.arange(WIDE_SAMPLES) - (start + late)[:, None]) / RISE + 0.5
        since = np.maximum(since, 0)
        total += size[:, None] * np.square(np.square(since * np.exp(1 - since)))
    return total


def _seats(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what many seats scatter: random taps under a power of the delay, as pulses [n, K]."""
    after = np.arange(WIDE_SAMPLES) - start[:, None] - 2
    shape = np.where(after > 0, (1 + np.maximum(after, 0) / 20) ** -2.2, 0)
    loud = 0.02 * GAIN / np.sqrt(rows["true_range_m"].to_numpy(np.float64))
    taps = rng.normal(size=(2, *shape.shape)) * shape * loud[:, None]
    pulse = _sum(np.array([4.0]), np.zeros((1, 1)), np.ones((1, 1), complex))[0, :12].real
    spread = np.fft.fft(taps[0] + 1j * taps[1], 256) * np.fft.fft(pulse, 256)
    return np.asarray(np.fft.ifft(spread)[:, 4 : 4 + WIDE_SAMPLES])
