"""Tins on belts and carts in a fish cannery, which brackets under its roof range: ranges, levels.

numpy and pandas alone; what it can hide is in `cannery_effects`, its waveforms in `cannery_waves`.
The hall and the channel are known, line of sight is not. Four brackets poll each lot that passes,
each for as long as it hears it: from once to twelve times in a row.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.cannery_effects import EFFECTS
from bench.challenge.families.cannery_hall import (
    BETWEEN,
    BRACKETS_M,
    COURSE,
    HALL_M,
    LAWS,
    RETORTS_M,
    SHIFT_S,
    TAGS,
    TINS,
    Harm,
    Lot,
    moved_on,
    place,
)
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
Places = NDArray[np.intp]
POLLS = (12, 14, 13, 12, 10, 9, 8, 7, 5, 3, 2, 1)
"""Of how many links each number of polls is, from one on."""
POLL_S, SLOT_S, HEARD = 0.34, 0.019, 4  # between polls, between brackets; brackets of a lot
LOOPS = (0,) * 7 + (1,) * 6 + (2,) * 6 + (3,) * 5  # of lots
START_M = ((0.0, 30.0), (0.0, 30.0), (2.0, 48.0), (0.3, 12.0))  # along loops
SPEED_MPS = ((0.6, 1.2), (0.5, 1.0), (0.4, 0.75), (0.5, 1.15))
STOPPED = 7  # lots whose line stands
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
    "brine-on-lids": "brine_g",
    "tins-crowd": "crowd_percent",
    "sprocket-wobbles": "belt_m",
    "guard-let-down": "guard_cm",
    "oil-on-domes": "oil_um",
    "ice-heaped": "ice_kg",
    "air-knives-slow": "knife_rpm",
}
RARELY = ("blocked-path", "diffraction", "material-delay")
LAST_OF_ALL = ("play-in-the-filter", "shaku-from-one-bracket", "range-rounding")  # in turn
STEEL = {False: 0.17, True: 0.06}  # of links behind steel, and where these are to be rare
OTHERS = {False: (0.17, 0.11, 0.1), True: (0.04, 0.03, 0.02)}  # behind each of BETWEEN
OF_CHIP = 22.0  # counts: how sizes of noise scatter
OWN_DB: Floats = np.random.default_rng(1063).uniform(-1.2, 1.2, len(BRACKETS_M))


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the cannery's own."""
    rng = np.random.default_rng([1060, seed])
    rows = mixed(lots(rng, drawn.rare), drawn, near=True)
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = mixed(lots(rng, drawn.rare), drawn, near=False)
        rows["link"] = "next day " + rows["link"]
    rows = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(rows, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return lots(np.random.default_rng([1060, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _spoiled(clean, drawn, seed, 1)
    truth, _ = _spoiled(simulated, drawn, seed, 2)
    return Tables(
        recorded=shown(recorded, drawn.listed),
        clean=shown(clean, drawn.listed),
        simulated=shown(simulated, drawn.listed),
        truth=shown(truth, drawn.listed),
        shifts_m=metres,
    )


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without what moves lots, and what stands between unless listed."""
    bare = table.drop(columns=[*COURSE])
    return bare if listed else bare.drop(columns="obstacles")


def mixed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows, or where the mix is to differ mostly those of near links, or of far ones.

    Two thirds of the links, and of the others every fifth.
    """
    if drawn.same_mix:
        return rows
    middle = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    most = 2 * len(middle) // 3
    kept = [*middle.index[:most], *middle.index[most + 2 :: 5]]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def lots(rng: np.random.Generator, rare: str, polls: tuple[int, ...] = POLLS) -> pd.DataFrame:
    """Return what is known of the rows of a shift: lots, some on lines that stand."""
    many = rng.permutation(np.repeat(np.arange(1, len(polls) + 1), polls)).reshape(-1, HEARD)
    loops, stands = rng.permutation(LOOPS), rng.permutation(len(many)) < STOPPED
    begin_s = SHIFT_S * np.sort(rng.uniform(0.0, 1.0, len(many)))
    parts = [
        _lot(rng, k, int(loops[k]), many[k], float(begin_s[k]), bool(stands[k]))
        for k in range(len(many))
    ]
    table = pd.concat(parts, ignore_index=True)
    table["obstacles"] = _between(rng, table, rare)
    return table


def _lot(
    rng: np.random.Generator, number: int, loop: int, polls: Places, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one lot, which each bracket polls in a row as long as it hears it."""
    slot = np.repeat(np.arange(HEARD), polls)
    entered = rng.integers(0, 5, HEARD)
    poll = np.concatenate(
        [first + np.arange(one) for first, one in zip(entered, polls, strict=True)]
    )
    since = POLL_S * poll + SLOT_S * slot
    course = _course(rng, loop, stands, len(since)) | {"since_s": since, "poll": poll * 1.0}
    along = moved_on(course, since)
    tags = place(course["loop"], along)
    heard = _hearing(rng, tags.mean(axis=0))[slot]
    carts = loop == 3
    yaw = 0.0 if carts else rng.uniform(-np.pi, np.pi)  # pucks are put on belts as they come
    ahead = place(course["loop"], along + 0.01) - tags
    facing = np.arctan2(ahead[:, 1], ahead[:, 0]) + yaw
    return _written(tags, heard, facing).assign(
        **course,
        **_log(rng, len(since), loop),
        belt_m=rng.uniform(0.0, 80.0) + along,
        tx=TAGS[TINS + rng.integers(len(TAGS) - TINS) if carts else rng.integers(TINS)],
        link=[f"lot {number} by bracket {k}" for k in heard],
        environment=("seaming", "packing", "spiral", "retorts")[loop],
        time_s=begin_s + since,
    )


def _course(rng: np.random.Generator, loop: int, stands: bool, size: int) -> dict[str, Floats]:
    """Return what moves a lot, the same at all of its rows [n]."""
    once = {
        "loop": float(loop),
        "begun_m": rng.uniform(*START_M[loop]),
        "speed_mps": rng.uniform(*SPEED_MPS[loop]) * (not stands),
        "surge": rng.uniform(0.0, 0.6),
        "beat_s": rng.uniform(2.1, 4.4),
        "phase_rad": rng.uniform(-np.pi, np.pi),
    }
    return {name: np.full(size, value) for name, value in once.items()}


def _hearing(rng: np.random.Generator, middle: Floats) -> Places:
    """Return which brackets hear a lot [4]: two of the four nearest, and any two others."""
    order = np.argsort(np.hypot(*(BRACKETS_M - middle)[:, :2].T))
    near, others = rng.permutation(order[:4]), rng.permutation(order[4:])
    return np.asarray(rng.permutation(np.concatenate([near[:2], others[:2]])))


def _written(tags: Floats, bracket: Places, facing: Floats) -> pd.DataFrame:
    """Return where both ends of rows are, and from where tags hear brackets that face so [n]."""
    ends = {"tx": tags, "rx": BRACKETS_M[bracket]}
    columns = {
        f"{end}_{axis}_m": m[:, k] for end, m in ends.items() for k, axis in enumerate("xyz")
    }
    back = ends["rx"] - ends["tx"]
    return pd.DataFrame(columns).assign(
        rx=[f"bracket{k}" for k in bracket],
        true_range_m=np.sqrt(np.sum(back**2, axis=1)),
        azimuth_deg=np.degrees(np.arctan2(back[:, 1], back[:, 0]) - facing) % 360.0,
        **{f"room_{axis}_m": size for axis, size in zip("xyz", HALL_M, strict=True)},
        channel=2,
        prf_mhz=16.0,
    )


def _log(rng: np.random.Generator, size: int, loop: int) -> dict[str, Floats]:
    """Return what lines and carts log for each row: some of it is of the lot."""
    warm = (2.0, 1.0, 9.0, 19.0)[loop] * rng.uniform(0.2, 1.6)  # retorts are hot, packing is cold
    return {
        "temperature_c": rng.uniform(2.0, 13.0) + warm + rng.normal(0.0, 1.2, size),
        "reply_time_s": np.asarray(0.0025 * rng.integers(2, 26, size), np.float64),
        "brine_g": rng.gamma(1.5, 6.0) + rng.gamma(1.2, 4.0, size),
        "crowd_percent": 100.0 * np.clip(rng.beta(1.2, 1.2) + rng.normal(0.0, 0.2, size), 0.0, 1.0),
        "guard_cm": np.clip(rng.uniform(0.0, 80.0) + rng.normal(0.0, 14.0, size), 0.0, 85.0),
        "oil_um": rng.lognormal(2.6, 0.9) * rng.lognormal(0.0, 0.7, size),
        "ice_kg": rng.uniform(0.0, 26.0) + rng.triangular(0.0, 4.0, 22.0, size),
        "knife_rpm": 420.0 + 2900.0 * rng.beta(0.8, 1.6, size),
    }


def _between(rng: np.random.Generator, table: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what stands in straight paths: steel where these pass close by it, or other things."""
    ends = [f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xy"]
    where = table.groupby("link", sort=False)[ends].mean()
    close = _passed(where.to_numpy()) + rng.gamma(2.0, 0.8, len(where))
    rank = close.argsort().argsort() / len(where)
    luck = rng.random((len(where), len(BETWEEN)))
    steel, likely = rank < STEEL[rare == "diffraction"], OTHERS[rare == "material-delay"]
    kinds = np.array([*BETWEEN])
    some = [["metal"] if s else [*kinds[u < likely]] for s, u in zip(steel, luck, strict=True)]
    return table["link"].map(dict(zip(where.index, some, strict=True))).tolist()


def _passed(ways: Floats) -> Floats:
    """Return how close in m straight ways [n, 4] pass by the nearest of what is of steel [n]."""
    begin, along = ways[:, :2], ways[:, 2:] - ways[:, :2]
    off = RETORTS_M[:, None] - begin
    part = np.clip(np.sum(off * along, axis=2) / np.sum(along**2, axis=1), 0.05, 0.95)
    return np.asarray(np.hypot(*np.moveaxis(off - part[..., None] * along, 2, 0)).min(axis=0))


def under_the_roof(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in the open, brackets that differ, and a pattern that stands.

    Steel all about makes waves stand: along its way a link's level goes up and down.
    """
    lot = Lot(rows, 0, rng)
    depth = lot.by_link(rng.rayleigh, 1.15)
    length, angle = lot.by_link(rng.uniform, 1.4, 5.0), lot.by_link(rng.uniform, -np.pi, np.pi)
    way = np.cos(angle) * lot.of("tx_x_m") + np.sin(angle) * lot.of("tx_y_m")
    stands = depth * np.cos(2 * np.pi * way / length + lot.by_link(rng.uniform, -np.pi, np.pi))
    return np.asarray(-60.0 - 18.3 * np.log10(lot.far) + OWN_DB[lot.bracket] + stands)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the cannery's own radio.

    Ranges scatter by a logistic law, and links by an even one: what is near one is near all along.
    """
    lot, size = Lot(rows, 0, rng), len(rows)
    level = under_the_roof(rows, rng) + rng.logistic(0.0, 0.28, size)
    error = scatter * (lot.by_link(rng.uniform, -0.013, 0.013) + rng.logistic(0.0, 0.0084, size))
    return rows.assign(
        error_m=error,
        range_m=lot.far + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.4 - rng.gamma(1.6, 0.5, size),
        noise_std=OF_CHIP * (1 + 0.16 * (rng.random(size) ** 1.5 - 0.4)),
        preamble_count=128.0 - rng.binomial(9, 0.3, size),
    )


def _spoiled(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to ranges in m.

    Every effect draws by itself, whatever else is hidden; those of what is written come last.
    """
    metres = np.zeros((len(drawn.hidden), len(table)))
    late = [name for name in LAST_OF_ALL if name in drawn.hidden]
    for name in [*sorted({*drawn.hidden} - {*late}), *late]:
        rng = np.random.default_rng([1061, seed, side, *name.encode()])
        harm = EFFECTS[name](Lot(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = harm.metres
        table = _harmed(table, harm)
    return table, metres


def _harmed(table: pd.DataFrame, harm: Harm) -> pd.DataFrame:
    """Return the table after something went wrong with its rows."""
    error = table["error_m"] + harm.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + harm.all_db + 0.45 * np.asarray(harm.first_db),
        first_path_power_dbm=table["first_path_power_dbm"] + harm.all_db + harm.first_db,
        noise_std=table["noise_std"] * 10 ** (np.asarray(harm.noise_db) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(harm.symbols_db) / 20),
    )
