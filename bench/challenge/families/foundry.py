"""Hooks of cranes that run and swing in a foundry, ranged from columns and from each other.

numpy and pandas alone: ranges and levels; what they can hide is in `foundry_effects`, waveforms in
`foundry_waves`. The bay and the channel are known. A haul is asked at odd times, from once to 13
times, and not every column hears it every time.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.foundry_bay import (
    BAY_M,
    COLUMNS_M,
    CRANES,
    HUNG,
    LAWS,
    MOTION,
    SHIFT_S,
    STACKS,
    SWINGS,
    TROLLEY_M,
    Flaw,
    Pour,
    hangs,
)
from bench.challenge.families.foundry_effects import EFFECTS

Floats = NDArray[np.float64]
POLLS = (1, 2, 2, 3, 4, 5, 5, 6, 6, 7, 8, 8, 9, 10, 11, 12, 13)  # of hauls, in any order
SLOT_S, HEARD = 0.019, 0.8  # from one receiver to the next; share of polls that one answers
ASKED = 6  # receivers of a haul
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "time-lag": "time_s",
    "exchange-motion": "reply_time_s",
    "antenna-delay": "time_s",
    "clock-offset": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "slag-crusts": "slag_mm",
    "lining-heats": "lining_c",
    "shot-blaster-cycles": "time_s",
    "magnet-energised": "magnet_a",
    "graphite-settles": "graphite_g",
    "sand-dries": "sand_percent",
    "covers-touch-domes": "gap_mm",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
AT_LAST = ("cubits-from-one-column", "range-rounding")  # of what is written, in this order
FLASKS = {False: 0.17, True: 0.05}  # of links with flasks in the way, and where these are rare
LOUDER_DB = np.array([0.4, -1.1, 0.9, 0.0, -0.6, 1.2, -0.3, 0.5, -1.0, 0.7, -0.5, 0.2, -0.4])
NOISE = np.array([96.0, 93.0, 99.0, 95.0, 91.0, 97.0, 94.0, 92.0, 98.0, 104.0, 107.0, 103.0, 108.0])
"""What receiving devices hear more of, and their noise in counts: columns, then hooks."""
SYMBOLS = np.array([1018.0] * HUNG + [508.0] * CRANES)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the foundry's own."""
    rng = np.random.default_rng([1020, seed])
    rows = weighed(hauls(rng, drawn.rare), drawn, True)
    clean = _measured(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = weighed(hauls(rng, drawn.rare), drawn, False)
        rows = rows.assign(link="second bay, " + rows["link"])
    more = pd.concat([rows for _ in range(drawn.ratio)], ignore_index=True)
    return hidden_in(drawn, seed, clean, _measured(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return hauls(np.random.default_rng([1020, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _flawed(clean, drawn, seed, 0)
    truth, _ = _flawed(simulated, drawn, seed, 1)
    bare = [bared(table, drawn.listed) for table in (recorded, clean, simulated, truth)]
    return Tables(bare[0], bare[1], bare[2], bare[3], metres)


def bared(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how hooks move, and what stands between unless listed."""
    return table.drop(columns=[*MOTION, *(() if listed else ("obstacles",))])


def weighed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows, or where the mix is to differ those of most near links, or of most far ones.

    Three of five links by distance, and one of five of the others.
    """
    if drawn.same_mix:
        return rows
    rank = rows.groupby("link")["true_range_m"].mean().rank(ascending=near, method="first")
    kept = rank.index[(rank <= 0.6 * len(rank)) | (rank % 5 == 0)]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def hauls(rng: np.random.Generator, rare: str, polls: tuple[int, ...] = POLLS) -> pd.DataFrame:
    """Return what is known of the rows of a shift: hauls, in some of which all cranes stand."""
    many = rng.permutation(polls)
    stands = np.isin(np.arange(len(many)), rng.permutation(len(many))[:5])
    if rare == "exchange-motion":  # one haul of two polls and one of three alone
        stands = ~np.isin(np.arange(len(many)), [np.argmax(many == 2), np.argmax(many == 3)])
    begin_s = np.sort(rng.uniform(0.0, SHIFT_S, len(many)))
    parts = [_haul(rng, k, int(many[k]), begin_s[k], bool(stands[k])) for k in range(len(many))]
    table = pd.concat(parts, ignore_index=True)
    return table.assign(obstacles=_between(rng, table["link"], FLASKS[rare == "diffraction"]))


def _haul(
    rng: np.random.Generator, number: int, polls: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one haul: a hook asks columns, and the hooks beside its own, every now and then."""
    swings, bases, sender = _cranes(rng, stands), _bridges(rng), int(rng.integers(CRANES))
    asked = _asked(rng, bases, sender)
    heard = rng.random((polls, ASKED)) < HEARD
    heard[rng.integers(polls, size=ASKED), np.arange(ASKED)] = True  # once at least
    poll, slot = np.nonzero(heard)
    since = np.cumsum(rng.uniform(0.3, 0.55, polls))[poll] + SLOT_S * slot
    ear = asked[slot]
    table = pd.concat(
        [_end("tx", np.full(len(ear), HUNG + sender), since, bases, swings),
         _end("rx", ear, since, bases, swings)],
        axis=1,
    )  # fmt: skip
    apart = (table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy()
             - table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy())  # fmt: skip
    faces = rng.uniform(-np.pi, np.pi)  # which way the block of the hook hangs
    return table.assign(
        **_book(rng, len(ear), begin_s),
        true_range_m=np.linalg.norm(apart, axis=1),
        azimuth_deg=np.degrees(np.arctan2(apart[:, 1], apart[:, 0]) - faces) % 360,
        link=f"haul {number} to " + table["rx"].str.replace(r"(\d)", r" \1", regex=True),
        environment="melting end" if bases[HUNG + sender, 1] < 34 else "moulding end",
        since_s=since,
        time_s=begin_s + since,
        **dict(zip(("room_x_m", "room_y_m", "room_z_m"), BAY_M, strict=True)),
        channel=4,
        prf_mhz=64.0,
    )


def _cranes(rng: np.random.Generator, stands: bool) -> pd.DataFrame:
    """Return how all devices move [columns, then hooks]: SWINGS of each."""
    swings = pd.DataFrame(0.0, index=range(HUNG + CRANES), columns=list(SWINGS))
    swings["rope_m"] = np.r_[np.ones(HUNG), rng.uniform(6.8, 9.4, CRANES)]
    if not stands:
        hooks = swings.index[HUNG:]
        which = rng.choice((-1, 1), CRANES)
        swings.loc[hooks, "run_m_per_s"] = which * rng.uniform(0.4, 1.2, CRANES)
        swings.loc[hooks, "swing_m"] = rng.uniform(0.1, 0.6, CRANES)
        swings.loc[hooks, "sway_m"] = rng.uniform(-0.7, 0.7, CRANES)
        swings.loc[hooks, "phase_rad"] = rng.uniform(0, 2 * np.pi, CRANES)
    return swings


def _bridges(rng: np.random.Generator) -> Floats:
    """Return where columns are, and trolleys of cranes, one in each quarter of the bay [13, 3]."""
    y = 17.0 * np.arange(CRANES) + rng.uniform(5.0, 12.0, CRANES)
    trolleys = [rng.uniform(3.5, BAY_M[0] - 3.5, CRANES), y, np.full(CRANES, TROLLEY_M)]
    return np.vstack([COLUMNS_M, np.stack(trolleys, axis=1)])


def _asked(rng: np.random.Generator, bases: Floats, sender: int) -> NDArray[np.intp]:
    """Return which devices a hook asks [ASKED]: the hooks beside it, and columns, mostly near."""
    beside = HUNG + np.array([k for k in (sender - 1, sender + 1) if 0 <= k < CRANES])
    far = np.linalg.norm((COLUMNS_M - bases[HUNG + sender])[:, :2], axis=1)
    order = np.argsort(far * rng.uniform(0.5, 1.5, HUNG))
    return np.concatenate([order[: ASKED - len(beside)], beside]).astype(np.intp)


def _end(
    end: str, device: NDArray[np.intp], since: Floats, bases: Floats, swings: pd.DataFrame
) -> pd.DataFrame:
    """Return where devices [n] are at times [n] in s, how they move, and what they are called."""
    moves = swings.iloc[device].reset_index(drop=True)
    place = bases[device] + hangs(moves, since)
    hook = device >= HUNG
    place[:, 2] -= np.where(hook, moves["rope_m"], 0.0)
    names = [f"hook{k - HUNG}" if k >= HUNG else f"column{k}" for k in device.tolist()]
    out = moves.add_prefix(f"{end}_").assign(**{end: names})
    return out.assign(**{f"{end}_{axis}_m": place[:, k] for k, axis in enumerate("xyz")})


def _book(rng: np.random.Generator, size: int, begin_s: float) -> dict[str, Floats]:
    """Return what is kept of a haul, for each row: hauls differ, and their rows from each other."""
    heat = rng.uniform(0.0, 1.0)
    return {
        "temperature_c": 6.0 + 34.0 * (0.6 * heat + 0.4 * rng.random()) + rng.normal(0, 1.5, size),
        "reply_time_s": 0.004 * (1 + rng.geometric(0.16, size).clip(max=20)),
        "slag_mm": rng.gamma(1.6, 3.0) + rng.gamma(1.2, 2.5, size),
        "lining_c": 180.0 + 700.0 * heat + 250.0 * rng.random(size),
        "magnet_a": np.abs(rng.uniform(0.0, 110.0) + rng.normal(0.0, 22.0, size)),
        "graphite_g": (2.0 + 26.0 * begin_s / SHIFT_S) * rng.uniform(0.2, 1.4, size),
        "sand_percent": rng.uniform(2.4, 5.0) + rng.triangular(-0.8, 0.0, 1.6, size),
        "gap_mm": 1.6 + 12.0 * rng.beta(1.2, 1.6, size),
    }


def _between(rng: np.random.Generator, links: pd.Series, flasks: float) -> pd.Series:
    """Return what stands in straight paths: flasks of steel, stacks and walls, or nothing."""
    made: dict[str, list[str]] = {}
    for link in links.unique():
        luck = rng.random(1 + len(STACKS))
        some = [kind for kind, u in zip(STACKS, luck[1:], strict=True) if u < 0.15]
        made[link] = ["metal"] if luck[0] < flasks else some
    return links.map(made)


def under_the_bridges(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: steel all about returns some of what is lost [n]."""
    ear = Pour(rows, 0, np.random.default_rng(0)).ear
    return np.asarray(-60.3 - 17.6 * np.log10(rows["true_range_m"].to_numpy()) + LOUDER_DB[ear])


def heard_by(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is reported of noise in counts, [n] each."""
    ear = Pour(rows, 0, rng).ear
    symbols = SYMBOLS[ear] - rng.poisson(5.0, len(ear))
    usual = NOISE[ear] * np.sqrt(SYMBOLS[ear] / 1018.0)
    return symbols.astype(np.float64), usual * rng.gamma(900.0, 1 / 900.0, len(ear))


def _measured(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the foundry's own radio."""
    size, link = len(rows), pd.factorize(rows["link"])[0]
    level = under_the_bridges(rows) + rng.normal(0.0, 1.3, link.max() + 1)[link]
    level = level + rng.uniform(-0.7, 0.7, size)
    wide = np.where(rng.random(size) < 0.12, 0.042, 0.015)
    error = scatter * wide * rng.standard_normal(size)
    symbols, noise = heard_by(rows, rng)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.6 - rng.gamma(2.0, 0.45, size),
        noise_std=noise,
        preamble_count=symbols,
    )


def _flawed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m.

    Each draws from a stream of its own, whatever else is hidden.
    """
    metres = {name: np.zeros(len(table)) for name in drawn.hidden}
    first = [name for name in drawn.hidden if name not in AT_LAST]
    for name in (*first, *(name for name in AT_LAST if name in drawn.hidden)):
        rng = np.random.default_rng([1022, seed, side, [*EFFECTS].index(name)])
        flaw = EFFECTS[name](Pour(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[name], table = flaw.metres, _with(table, flaw)
    return table, np.reshape([*metres.values()], (len(metres), len(table)))


def _with(table: pd.DataFrame, flaw: Flaw) -> pd.DataFrame:
    """Return the table with what is wrong with its rows."""
    whole, edge = np.asarray(flaw.all_db), np.asarray(flaw.edge_db)
    error = table["error_m"].to_numpy() + flaw.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + whole + 0.55 * edge,
        first_path_power_dbm=table["first_path_power_dbm"] + whole + edge,
        noise_std=table["noise_std"] * 10 ** (np.asarray(flaw.noise_db) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(flaw.count_db) / 20),
    )
