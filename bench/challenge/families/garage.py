"""People who walk up to cars in a garage, whose phones anchors of the cars range: ranges, levels.

numpy and pandas alone; what it can hide is in `garage_effects`, its waveforms in `garage_waves`.
Ways are short. The room, the channel and line of sight are known. Anchors near by ask in every
block of a visit, others in every second or third: from once to 14 times.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.garage_cars import (
    AFTERNOON_S,
    ANCHORS_M,
    BETWEEN,
    CARS_M,
    FACING,
    GARAGE_M,
    LAWS,
    PHONES,
    STRIDE,
    Visit,
    Wrong,
    reached,
)
from bench.challenge.families.garage_effects import EFFECTS

Floats = NDArray[np.float64]
Places = NDArray[np.intp]
BLOCKS = (1, 1, 2, 3, 3, 4, 5, 5, 6, 7, 7, 8, 9, 9, 10, 11, 11, 12, 12, 13, 14)  # of visits
BLOCK_S, SLOT_S = 0.27, 0.012
EVERY = (1, 1, 2, 2, 3)  # of how many blocks an anchor asks in one, from the nearest on
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
    "rain-on-paint": "rain_g",
    "hotspot-shares-the-air": "wifi_percent",
    "arms-swing": "walked_m",
    "doors-opened": "door_deg",
    "sun-on-dashboards": "lux",
    "hands-cover": "hand_cm2",
    "charge-runs-out": "charge_percent",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
AS_WRITTEN = ("ranges-rise-slowly", "quarters-from-one-anchor", "range-rounding")  # last, in turn
BODY = {False: 0.17, True: 0.05}  # of links by a car's body, and where these are to be rare
OWN_DB = np.array([0.8, -0.7, 0.3, -1.2, 1.0, 0.0, -0.4])  # what phones hear more of


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the garage's own."""
    rng = np.random.default_rng([1040, seed])
    rows = apart(visits(rng, drawn.rare), drawn, 1.0)
    clean = _told(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = apart(visits(rng, drawn.rare), drawn, -1.0)
        rows["link"] = "next day " + rows["link"]
    rows = rows.loc[[*rows.index] * drawn.ratio].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _told(rows, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return visits(np.random.default_rng([1040, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _gone_wrong(clean, drawn, (seed, 1))
    truth, _ = _gone_wrong(simulated, drawn, (seed, 2))
    return Tables(
        recorded=seen(recorded, drawn.listed),
        clean=seen(clean, drawn.listed),
        simulated=seen(simulated, drawn.listed),
        truth=seen(truth, drawn.listed),
        shifts_m=metres,
    )


def seen(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how people walk, and what stands between unless listed."""
    hidden = [*STRIDE] if listed else [*STRIDE, "obstacles"]
    return table[[name for name in table if name not in hidden]]


def apart(rows: pd.DataFrame, drawn: Draw, sign: float) -> pd.DataFrame:
    """Return all rows, or where the mix is to differ mostly those of near links (1), or far (-1).

    All of five in eight, of the others every fourth.
    """
    if drawn.same_mix:
        return rows
    off = (sign * rows["true_range_m"]).groupby(rows["link"]).median().sort_values()
    cut = 5 * len(off) // 8
    kept = {*off.index[:cut], *off.index[cut + 2 :: 4]}
    return rows[[link in kept for link in rows["link"]]].reset_index(drop=True)


def visits(rng: np.random.Generator, rare: str, blocks: tuple[int, ...] = BLOCKS) -> pd.DataFrame:
    """Return what is known of the rows of an afternoon: visits, in some of which people stand."""
    many = list(rng.permutation(blocks))
    stand = set(rng.permutation(len(many))[:6].tolist())
    if rare == "exchange-motion":  # one visit of two blocks and one of four alone are walked
        stand = set(range(len(many))) - {many.index(2), many.index(4)}
    begin_s = AFTERNOON_S * np.sort(rng.beta(1.1, 1.3, len(many)))
    parts = [_visit(rng, k, int(many[k]), float(begin_s[k]), k in stand) for k in range(len(many))]
    table = pd.concat(parts, ignore_index=True)
    table["obstacles"] = _in_between(rng, table, BODY[rare == "diffraction"])
    return table.assign(los=[not some for some in table["obstacles"]])


def _visit(
    rng: np.random.Generator, number: int, blocks: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one visit: block after block, some anchors ask a phone."""
    start, ahead, walk_m = _walk(rng)
    walk_s = walk_m / rng.uniform(0.62, 1.0)
    asked = _asked(rng, start + 0.5 * walk_m * np.array([np.cos(ahead), np.sin(ahead)]))
    block, slot = np.array(
        [(b, k) for b in range(blocks) for k, every in enumerate(EVERY) if b % every == k % every]
        + [(0, k) for k, every in enumerate(EVERY) if blocks <= k % every]  # once at least
    ).T
    since = BLOCK_S * block + SLOT_S * slot
    gone = since + rng.uniform(0.08, 0.92) * max(walk_s - BLOCK_S * blocks, 0.3)
    walk_m = 0.0 if stands else walk_m
    walked = reached(np.full(len(gone), walk_m), np.full(len(gone), walk_s), gone)
    phone = np.array([*start, rng.uniform(0.45, 1.45)]) + np.outer(
        walked, [np.cos(ahead), np.sin(ahead), 0.0]
    )
    table = _placed(asked[slot], phone, rng.uniform(-np.pi, np.pi) if stands else ahead)
    return table.assign(
        **_diary(rng, len(gone)),
        **dict(zip(STRIDE, (ahead, walk_m, walk_s, gone), strict=True)),
        walked_m=rng.uniform(0.0, 60.0) + walked,
        link=[f"visit {number} from anchor {k}" for k in asked[slot]],
        rx=f"phone{rng.integers(PHONES)}",
        environment="by the van" if start[0] > 7.4 else "by the estate",
        time_s=begin_s + since,
    )


def _placed(anchor: Places, phone: Floats, ahead: float) -> pd.DataFrame:
    """Return where both ends of rows are, and how phones are turned that look ahead [n]."""
    ends = np.hstack([ANCHORS_M[anchor], phone])
    names = [f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"]
    back = ends[:, :3] - ends[:, 3:]
    return pd.DataFrame(ends, columns=names).assign(
        tx=[f"anchor{k}" for k in anchor],
        true_range_m=np.sqrt(np.sum(back**2, axis=1)),
        azimuth_deg=(np.degrees(np.arctan2(back[:, 1], back[:, 0]) - ahead)) % 360.0,
        room_x_m=GARAGE_M[0],
        room_y_m=GARAGE_M[1],
        room_z_m=GARAGE_M[2],
        channel=9,
        prf_mhz=64.0,
    )


def _walk(rng: np.random.Generator) -> tuple[Floats, float, float]:
    """Return where a walk starts [2], which way in radians and how far in m it goes: past cars."""
    while True:
        start = rng.uniform(0.5, (GARAGE_M[0] - 0.5, GARAGE_M[1] - 0.5))
        ahead, far = rng.uniform(-np.pi, np.pi), rng.uniform(2.6, 8.0)
        way = start + np.linspace(0, far, 25)[:, None] * np.array([np.cos(ahead), np.sin(ahead)])
        inside = np.all((way > 0.4) & (way < np.array(GARAGE_M[:2]) - 0.4))
        if inside and not any(_hits(way, car) for car in CARS_M):
            return start, float(ahead), float(far)


def _hits(way: Floats, car: tuple[float, float, float, float]) -> bool:
    """Return whether places [k, 2] come closer to a car than 0.75 m."""
    x, y = way.T
    near = (x > car[0] - 0.75) & (x < car[1] + 0.75) & (y > car[2] - 0.75) & (y < car[3] + 0.75)
    return bool(near.any())


def _asked(rng: np.random.Generator, middle: Floats) -> Places:
    """Return which anchors ask [5], from the nearest on: the three nearest, and any two."""
    order = np.argsort(np.hypot(*(ANCHORS_M[:, :2] - middle).T))
    return np.concatenate([order[:3], order[3 + np.sort(rng.permutation(len(order) - 3)[:2])]])


def _diary(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return what phones and cars keep of a visit, for each row: some of it is of the visit."""
    swing = np.clip(rng.uniform(0.0, 66.0) + rng.normal(0.0, 9.0, size), 0.0, 72.0)
    charge = 5.0 + 60.0 * rng.beta(0.9, 1.5) + rng.uniform(0.0, 28.0, size)
    return {
        "temperature_c": rng.uniform(-6.0, 27.0) + rng.uniform(-2.0, 2.0, size),
        "reply_time_s": 0.003 * rng.integers(1, 27, size),
        "rain_g": rng.exponential(9.0) + rng.exponential(6.0, size),
        "wifi_percent": 100.0 * rng.beta(1.0, 1.2, size),
        "door_deg": swing,
        "lux": np.exp(rng.normal(4.6, 1.1) + rng.normal(0.0, 0.7, size)),
        "hand_cm2": rng.triangular(0.0, 24.0, 62.0, size),
        "charge_percent": charge,
    }


def _in_between(rng: np.random.Generator, table: pd.DataFrame, body: float) -> list[list[str]]:
    """Return what stands in straight paths: the car behind which an anchor is, or something else.

    The car's body where phones are most behind anchors, something else the likelier the more so.
    """
    where = table.groupby("link", sort=False)[["rx_x_m", "rx_y_m", "tx_x_m", "tx_y_m"]].mean()
    off = where.to_numpy()[:, :2] - where.to_numpy()[:, 2:]
    anchor = where.index.str[-1].astype(int).to_numpy()
    faced = np.sum(off * FACING[anchor], axis=1) / np.hypot(*off.T)
    rank = (faced + rng.normal(0, 0.25, len(faced))).argsort().argsort() / len(faced)
    luck = rng.random((len(faced), len(BETWEEN)))
    likely = np.where(rank < 0.6, 0.17, 0.1)
    some = {
        link: ["metal"] if rank[k] < body
        else [kind for kind, u in zip(BETWEEN, luck[k], strict=True) if u < likely[k]]
        for k, link in enumerate(where.index)
    }  # fmt: skip
    return table["link"].map(some).tolist()


def between_cars(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, a ceiling close above, phones that differ [n]."""
    visit = Visit(rows, 0, np.random.default_rng(0))
    return np.asarray(-65.2 - 18.8 * np.log10(visit.off) + OWN_DB[visit.phone])


def _told(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the garage's own radio.

    Ranges have a part that all rows of a link share: what else is near is near for all of them.
    """
    visit, size = Visit(rows, 0, rng), len(rows)
    level = between_cars(rows) + visit.each_link(rng.triangular, -2.4, 0.0, 2.4)
    level = level + rng.laplace(0.0, 0.45, size)
    error = scatter * (visit.each_link(rng.normal, 0.0, 0.006) + rng.laplace(0.0, 0.0095, size))
    return rows.assign(
        error_m=error,
        range_m=visit.off + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.5 - rng.exponential(0.8, size),
        noise_std=44.0 * (1 + 0.13 * (rng.beta(2.0, 4.0, size) - 1 / 3)),
        preamble_count=254.0 - np.floor(6.0 * rng.random(size) ** 2),
    )


def _gone_wrong(
    table: pd.DataFrame, drawn: Draw, seeds: tuple[int, int]
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m.

    Every effect has random numbers of its own, whatever else is hidden.
    """
    metres = np.zeros((len(drawn.hidden), len(table)))
    turn = {name: k for k, name in enumerate(AS_WRITTEN)}
    for name in sorted(drawn.hidden, key=lambda one: turn.get(one, -1)):
        rng = np.random.default_rng([1043, *seeds, sum(map(ord, name))])
        visit = Visit(table, seeds[0], rng, drawn.rare != "")
        wrong = EFFECTS[name](visit, drawn.strength)
        metres[drawn.hidden.index(name)] = wrong.get("metres", 0.0)
        table = _after(table, wrong)
    return table, metres


def _after(table: pd.DataFrame, wrong: Wrong) -> pd.DataFrame:
    """Return the table after something went wrong with its rows."""
    none = np.zeros(len(table))
    metres, whole, edge, hiss, count = (
        wrong.get(name, none) for name in ("metres", "whole", "edge", "hiss", "count")
    )
    out = table.copy()
    out["error_m"] += metres
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["rx_power_dbm"] += whole + 0.5 * edge
    out["first_path_power_dbm"] += whole + edge
    out["noise_std"] *= 10 ** (hiss / 20)
    out["preamble_count"] *= 10 ** (count / 20)
    return out
