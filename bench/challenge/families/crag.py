"""Harnesses in a climbing hall, ranged from bolts in its walls: ranges and levels.

numpy and pandas alone; what it can hide is in `crag_effects`, waveforms in `crag_waves`. Hall and
channel are known, line of sight is not. Four bolts range each who climbs, hangs or is let down.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.crag_effects import EFFECTS
from bench.challenge.families.crag_wall import (
    BETWEEN,
    BOLTS,
    BOLTS_M,
    EVENING_S,
    GAIT,
    HALL_M,
    HARNESSES,
    LAWS,
    ROUTES,
    Ascent,
    Slip,
    on_route,
)

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
OF_LINKS = (13, 12, 12, 12, 12, 12, 12, 12, 11)
"""How many links have one row, two rows and so on."""
NEAR, HANGING = 4, 7  # bolts of an ascent; ascents in which somebody hangs still
ROUND_S, SLOT_S = 0.31, 0.017  # from one round of bolts to the next, and from bolt to bolt
LEFT, STEEL = {False: 0.15, True: 0.03}, {False: 0.18, True: 0.055}  # shares of links
KNOWN = tuple(one for one in EFFECTS if one not in LAWS)
CAUSES = {
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "antenna-pattern": "azimuth_deg",
    "temperature-drift": "temperature_c",
    "chalk-on-tags": "chalk_g",
    "gear-hangs-before": "gear_kg",
    "seams-passed": "route_m",
    "destratifiers-run": "fan_rpm",
    "sweat-in-straps": "sweat_g",
    "air-dries-resin": "dew_point_c",
    "lamps-dimmed": "lamp_v",
} | dict.fromkeys(("power-bias", "path-loss", "range-scale", "level-control"), "true_range_m")
RARELY = ("blocked-path", "diffraction")
AT_LAST = {"means-since-begun": 1, "braccia-from-one-bolt": 2, "range-rounding": 3}
"""What becomes of ranges after all else, in this order."""
SUMS, ROOT_NOISE = 248.0, 3.9  # symbols of a sum; counts of noise for each root of one
GAIN_DB: Floats = np.random.default_rng(1212).triangular(-1.5, 0.0, 1.5, BOLTS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the crag's own."""
    rng = np.random.default_rng([seed, 1210])
    rows = mixed(ascents(rng, drawn.rare), drawn, 1)
    clean = _heard(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = mixed(ascents(rng, drawn.rare), drawn, -1)
        rows = rows.assign(link="other evening, " + rows["link"])
    more = pd.concat([rows for _ in range(drawn.ratio)], ignore_index=True)
    return hidden_in(drawn, seed, clean, _heard(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return ascents(np.random.default_rng([seed, 1210]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    (found, metres), (true, _) = (
        _slipped(table, drawn, [seed, side]) for side, table in enumerate((clean, simulated))
    )
    found, clean, simulated, true = (
        told(table, drawn.listed) for table in (found, clean, simulated, true)
    )
    return Tables(found, clean, simulated, true, metres)


def told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without gaits, and unless it is listed without what ways go through."""
    return table.drop(columns=[*GAIT, *(() if listed else ("obstacles",))], errors="ignore")


def mixed(rows: pd.DataFrame, drawn: Draw, sign: int) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more near links (1), or far ones (-1).

    Three of five links are all there, of the others every seventh.
    """
    if drawn.same_mix:
        return rows
    rank = (sign * rows.groupby("link")["true_range_m"].mean()).rank(method="first")
    stay = rank.index[(rank <= 0.6 * len(rank)) | (rank % 7 == 0)]
    return rows[rows["link"].isin(stay)].reset_index(drop=True)


def ascents(
    rng: np.random.Generator, rare: str, of_links: tuple[int, ...] = OF_LINKS
) -> pd.DataFrame:
    """Return what is known of the rows of an evening."""
    each = np.repeat(np.arange(1, len(of_links) + 1), of_links)
    sizes = rng.permutation(each).reshape(-1, NEAR)
    starts = np.sort(EVENING_S * rng.beta(1.3, 1.1, len(sizes)))
    hangs = np.isin(np.arange(len(sizes)), rng.choice(len(sizes), HANGING, replace=False))
    rows = pd.concat(
        [_ascent(rng, k, sizes[k], float(starts[k]), bool(hangs[k])) for k in range(len(sizes))],
        ignore_index=True,
    )
    rows["obstacles"] = _between(rng, rows, rare)
    return rows


def _ascent(
    rng: np.random.Generator, number: int, sizes: Whole, start_s: float, hangs: bool
) -> pd.DataFrame:
    """Return one ascent: bolts range a harness in rounds, some of which a bolt may miss."""
    turns = [int(rng.integers(0, 4)) + np.arange(size) for size in sizes]
    slot = np.repeat(np.arange(NEAR), sizes)
    since = ROUND_S * np.concatenate(turns) + SLOT_S * slot
    gait = _gait(rng, hangs, len(since)) | {"since_s": since}
    tag = on_route(gait, since)
    bolt = _who(rng, tag.mean(axis=0))[slot]
    ways = BOLTS_M[bolt] - tag
    looks = ROUTES[int(gait["route"][0]), 2:4]
    faces = np.arctan2(-looks[1], -looks[0]) + rng.vonmises(0.0, 2.5)
    sensors = _sensors(rng, len(since), float(tag[:, 2].mean()))
    ends = {f"tx_{a}_m": tag[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": BOLTS_M[bolt, k] for k, a in enumerate("xyz")}
    ends |= {f"room_{a}_m": np.full(len(since), HALL_M[k]) for k, a in enumerate("xyz")}
    return pd.DataFrame(gait | ends | sensors).assign(
        tx=f"harness{rng.integers(HARNESSES)}",
        rx=[f"bolt{one}" for one in bolt],
        link=[f"ascent {number} at bolt {one}" for one in bolt],
        environment="tower" if 10 < tag[0, 0] < 17 and tag[0, 1] > 6 else "walls",
        true_range_m=np.sqrt((ways**2).sum(axis=1)),
        azimuth_deg=np.degrees(np.arctan2(ways[:, 1], ways[:, 0]) - faces) % 360,
        route_m=rng.uniform(0.0, 30.0) + tag[:, 2],  # from a mark at some height
        time_s=start_s + since,
        channel=5,
        prf_mhz=64.0,
    )


def _gait(rng: np.random.Generator, hangs: bool, size: int) -> dict[str, Floats]:
    """Return how somebody moves, alike at all rows [size]: two of three climb, others come down."""
    down = rng.random() < 1 / 3
    one = {
        "route": float(rng.integers(len(ROUTES))),
        "begun_m": rng.uniform(7.0, 12.0) if down else rng.uniform(0.2, 8.5),
        "reach_m": (-rng.uniform(2.6, 4.2) if down else rng.uniform(0.8, 1.9)) * (not hangs),
        "beat_s": rng.uniform(3.6, 6.0),
        "jerk": rng.uniform(0.0, 0.2) if down else rng.uniform(0.2, 0.65),
        "phase": rng.uniform(0.0, 1.0),
        "swing_m": rng.gamma(3.0, 0.035) * (not hangs),
    }
    return {name: np.full(size, value, np.float64) for name, value in one.items()}


def _who(rng: np.random.Generator, tag: Floats) -> Whole:
    """Return which bolts range a harness [NEAR]: near ones more likely than far ones."""
    far = np.sqrt(((BOLTS_M - tag) ** 2).sum(axis=1))
    odds = 1 / (4.0 + far)
    return rng.choice(BOLTS, NEAR, replace=False, p=odds / odds.sum())


def _sensors(rng: np.random.Generator, size: int, high_m: float) -> dict[str, Floats]:
    """Return what is logged for each row: it is warmer below the roof."""
    warm = 12.0 + 0.75 * high_m + rng.uniform(-2.0, 8.0)
    return {
        "temperature_c": warm + rng.normal(0.0, 0.9, size),
        "reply_time_s": rng.choice((0.008, 0.016, 0.024, 0.036, 0.048, 0.064), size),
        "chalk_g": rng.exponential(5.0) + rng.exponential(3.5, size),
        "gear_kg": np.clip(rng.uniform(0.0, 8.0) + rng.normal(0.0, 1.3, size), 0.0, 9.5),
        "fan_rpm": np.clip(rng.uniform(0.0, 900.0) + rng.normal(0.0, 150.0, size), 0.0, 980.0),
        "sweat_g": rng.gamma(1.2, 8.0) + rng.gamma(1.1, 6.0, size),
        "dew_point_c": rng.uniform(-2.0, 12.0) + rng.normal(0.0, 2.2, size),
        "lamp_v": 9.0 + 39.0 * rng.beta(0.9, 1.5, size),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: a stage of steel, more often far away, or others."""
    far = rows.groupby("link", sort=False)["true_range_m"].mean()
    luck = rng.random(len(far)) + far.to_numpy() / 45.0
    steel = luck > np.quantile(luck, 1 - STEEL[rare == "diffraction"])
    some = rng.random((len(far), len(BETWEEN))) < LEFT[rare in RARELY]
    kinds = [
        ["metal"] if iron else [kind for kind, there in zip(BETWEEN, row, strict=True) if there]
        for iron, row in zip(steel, some, strict=True)
    ]
    return [kinds[one] for one in pd.factorize(rows["link"])[0]]


def off_walls(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in the open, bolts that differ, bodies and walls by links."""
    ascent = Ascent(rows, 0, rng)
    walls = ascent.each(lambda n: rng.normal(0.0, 1.0, n) - rng.exponential(0.8, n))
    return np.asarray(-63.4 - 17.6 * np.log10(ascent.apart) + GAIN_DB[ascent.bolt] + walls)


def summed(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are summed up, and what is told of noise in counts, [n] each."""
    sums = SUMS - rng.poisson(3.0, len(rows))
    told_of = ROOT_NOISE * np.sqrt(sums) * rng.lognormal(0.0, 0.035, len(rows))
    return np.asarray(sums, np.float64), np.asarray(
        told_of * 10 ** (GAIN_DB[Ascent(rows, 0, rng).bolt] / 60)
    )


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the crag's own ranges and levels.

    Ranges scatter by Student's law of six, weak ones more.
    """
    level = off_walls(rows, rng)
    fresh = 0.35 * rng.standard_normal(len(rows))
    spread = 0.0095 * np.sqrt(1 + 10 ** ((-86.0 - level) / 9))
    error = scatter * spread * rng.standard_t(6.0, len(rows))
    sums, noise = summed(rows, rng)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level + fresh,
        first_path_power_dbm=level + fresh - 0.5 - rng.weibull(1.4, len(rows)),
        noise_std=noise,
        preamble_count=sums,
    )


def _slipped(table: pd.DataFrame, drawn: Draw, of: list[int]) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m.

    Draws of one do not depend on others.
    """
    metres = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: (AT_LAST.get(one, 0), one)):
        rng = np.random.default_rng([1213, *of, *map(ord, name)])
        slip = EFFECTS[name](Ascent(table, of[0], rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = slip.metres
        table = _with(table, slip)
    return table, metres


def _with(table: pd.DataFrame, slip: Slip) -> pd.DataFrame:
    """Return the table with what its rows get."""
    now = {
        "error_m": table["error_m"] + slip.metres,
        "range_m": table["true_range_m"] + table["error_m"] + slip.metres,
        "rx_power_dbm": table["rx_power_dbm"] + slip.gain + 0.4 * np.asarray(slip.first),
        "first_path_power_dbm": table["first_path_power_dbm"] + slip.gain + slip.first,
        "noise_std": table["noise_std"] * 10 ** (np.asarray(slip.hiss) / 20),
        "preamble_count": table["preamble_count"] * 10 ** (np.asarray(slip.sums) / 20),
    }
    return table.assign(**now)
