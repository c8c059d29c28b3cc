"""Tugs and boom lifts in a hangar, ranged from its girders: ranges and levels.

numpy and pandas alone; what it can hide is in `hangar_effects`, waveforms in `hangar_waves`.
Walls and channel are known, line of sight is not. Five girders range each job of a tug or a lift.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.hangar_bay import (
    BETWEEN,
    DAY_S,
    GIRDERS,
    GIRDERS_M,
    HALL_M,
    LAWS,
    LIFTS,
    TUGS,
    WAY,
    Job,
    Toll,
    swung,
)
from bench.challenge.families.hangar_effects import EFFECTS

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Job", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
OF_LINKS = (13, 12, 12, 12, 12, 11, 11, 11, 11)
"""How many links have one row, two rows and so on."""
HEARD_BY, PARKED = 5, 5  # girders of a job; jobs whose tag rests
ROUND_S, SLOT_S = 0.29, 0.013  # from one round of girders to the next, and between girders
SHARES, STEEL = {False: 0.16, True: 0.04}, {False: 0.18, True: 0.055}  # of links
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    **dict.fromkeys(("antenna-delay", "time-lag"), "time_s"),
    **dict.fromkeys(("clock-offset", "exchange-motion"), "reply_time_s"),
    **dict.fromkeys(("power-bias", "path-loss", "range-scale", "level-control"), "true_range_m"),
    "antenna-pattern": "azimuth_deg",
    "temperature-drift": "temperature_c",
    "skydrol-on-domes": "skydrol_ml",
    "deicer-in-covers": "deicer_l",
    "tanks-vented": "vapour_percent",
    "lashing-rings-passed": "tow_m",
    "radiant-heaters-lit": "heater_kw",
    "humidity-swells-honeycomb": "humidity_percent",
    "ground-power-sags": "bus_v",
}
RARELY = ("blocked-path", "diffraction")
LATER = ("words-torn-in-reading", "arshins-from-one-girder", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SUMS, ROOT_NOISE = 505.0, 3.3  # symbols of a sum; counts of noise for each root of one
GAIN_DB: Floats = np.random.default_rng(1312).normal(0.0, 0.6, GIRDERS).clip(-1.2, 1.2)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the hangar's own."""
    rng = np.random.default_rng([seed, 1310])
    rows = thinned(jobs(rng, drawn.rare), drawn, near=True)
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = thinned(jobs(rng, drawn.rare), drawn, near=False)
        rows = rows.assign(link="other day, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return jobs(np.random.default_rng([seed, 1310]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _tolled(clean, drawn, seed, 0)
    truth, _ = _tolled(simulated, drawn, seed, 1)
    four = (recorded, clean, simulated, truth)
    recorded, clean, simulated, truth = (as_told(one, drawn.listed) for one in four)
    return Tables(recorded, clean, simulated, truth, metres)


def as_told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how tags go, and unless it is listed without obstacles."""
    unknown = [*WAY] if listed else [*WAY, "obstacles"]
    return table.drop(columns=unknown, errors="ignore")


def thinned(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more near links, or of more far ones.

    Of the nearer half, or the farther one, all links stay; of the others one in six.
    """
    if drawn.same_mix:
        return rows
    mean = rows.groupby("link")["true_range_m"].mean()
    order = mean.rank(method="first", ascending=near).astype(int)
    stay = order.index[(order <= 0.55 * len(order)) | (order % 6 == 0)]
    return rows[rows["link"].isin(stay)].reset_index(drop=True)


def jobs(rng: np.random.Generator, rare: str, of_links: tuple[int, ...] = OF_LINKS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    sizes = rng.permutation(np.repeat(1 + np.arange(len(of_links)), of_links)).reshape(-1, HEARD_BY)
    begins = np.sort(rng.uniform(0.0, DAY_S, len(sizes)))
    parked = rng.permutation(len(sizes)) < PARKED
    made = [_job(rng, k, own, begins[k], parked[k]) for k, own in enumerate(sizes)]
    rows = pd.concat(made, ignore_index=True)
    rows["obstacles"] = _obstacles(rng, rows, rare)
    return rows


def _job(
    rng: np.random.Generator, number: int, sizes: Whole, begin_s: float, parked: bool
) -> pd.DataFrame:
    """Return one job: girders range a tag round after round, and some begin some rounds later."""
    slot = np.repeat(np.arange(HEARD_BY), sizes)
    rounds = np.concatenate([rng.integers(0, 4) + np.arange(size) for size in sizes])
    since = ROUND_S * rounds + SLOT_S * slot
    lift = rng.random() < 0.4
    way = {k: np.full(len(since), v) for k, v in _way(rng, lift, parked).items()}
    way |= {"since_s": since}
    tag = swung(way, since)
    girder = _near(rng, tag.mean(axis=0))[slot]
    reach = GIRDERS_M[girder] - tag
    looks = float(way["begun"][0]) + (0.0 if lift else np.pi / 2 * float(way["sense"][0]))
    ends = {f"tx_{a}_m": tag[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": GIRDERS_M[girder, k] for k, a in enumerate("xyz")}
    ends |= {f"room_{a}_m": np.full(len(since), HALL_M[k]) for k, a in enumerate("xyz")}
    return pd.DataFrame(way | ends | _logged(rng, len(since), begin_s)).assign(
        tx=f"lift{rng.integers(LIFTS)}" if lift else f"tug{rng.integers(TUGS)}",
        rx=[f"girder{one}" for one in girder],
        link=[f"job {number} heard by girder{one}" for one in girder],
        environment="nose bay" if tag[0, 0] < HALL_M[0] / 2 else "tail bay",
        true_range_m=np.linalg.norm(reach, axis=1),
        azimuth_deg=np.degrees(np.arctan2(reach[:, 1], reach[:, 0]) - looks) % 360,
        time_s=begin_s + since,
        channel=2,
        prf_mhz=64.0,
    )


def _way(rng: np.random.Generator, lift: bool, parked: bool) -> dict[str, float]:
    """Return how a tag goes round: a basket about a turntable, a tug about a bend's middle."""
    begun, sense = rng.uniform(-np.pi, np.pi), float(rng.choice([-1.0, 1.0]))
    boom = rng.uniform(5.0, 10.5) if lift else rng.uniform(6.0, 18.0)
    there = rng.uniform((14.0, 13.0), (38.0, 25.0)) if lift else rng.uniform((9, 9), (43, 29))
    if not lift:  # is where the tug begins, not the middle
        there = there - boom * np.array([np.cos(begun), np.sin(begun)])
    slew = rng.uniform(0.05, 0.13) if lift else rng.uniform(0.7, 2.1) / boom
    moves = 0.0 if parked else 1.0
    return {
        "pivot_x": there[0],
        "pivot_y": there[1],
        "pivot_z": 1.9 if lift else rng.uniform(1.0, 1.35),
        "boom_m": boom,
        "begun": begun,
        "slew": moves * sense * slew,
        "tilt": lift * rng.uniform(0.15, 0.8),
        "tilts": moves * lift * rng.normal(0.0, 0.03),
        "ease": rng.uniform(0.0, 0.55),
        "beat": rng.uniform(0.9, 2.2),
        "turn": rng.uniform(0.0, 2 * np.pi),
        "sense": sense,
    }


def _near(rng: np.random.Generator, tag: Floats) -> Whole:
    """Return which girders range a tag [HEARD_BY]: a ranking by distance, blurred by chance."""
    far = np.linalg.norm(GIRDERS_M - tag, axis=1)
    return np.argsort(far * rng.lognormal(0.0, 0.45, GIRDERS))[:HEARD_BY]


def _logged(rng: np.random.Generator, size: int, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: it is coldest when doors are opened in the morning."""
    warm = 9.0 + 9.0 * begin_s / DAY_S + rng.uniform(-5.0, 8.0)
    damp = rng.uniform(25.0, 80.0)
    return {
        "temperature_c": warm + rng.normal(0.0, 1.0, size),
        "reply_time_s": rng.choice((0.006, 0.012, 0.02, 0.03, 0.044, 0.06), size),
        "skydrol_ml": rng.gamma(1.3, 9.0) + rng.gamma(1.2, 5.0, size),
        "deicer_l": rng.exponential(3.0) + rng.exponential(2.4, size),
        "vapour_percent": (rng.uniform(2.0, 80.0) + rng.normal(0.0, 12.0, size)).clip(1.0, 98.0),
        "tow_m": rng.uniform(0.0, 60.0) + np.cumsum(rng.uniform(0.2, 0.9, size)),
        "heater_kw": (rng.uniform(0.0, 48.0) + rng.normal(0.0, 8.0, size)).clip(0.0, 54.0),
        "humidity_percent": (damp + rng.normal(0.0, 7.0, size)).clip(12.0, 96.0),
        "bus_v": 8.5 + 20.0 * rng.beta(0.9, 1.3, size),
    }


def _obstacles(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: an aircraft, the likelier the farther; or others."""
    number, links = pd.factorize(rows["link"])
    far = rows.groupby(number)["true_range_m"].mean().to_numpy()
    odds = rng.random(len(links)) + far / 60.0
    steel = odds > np.quantile(odds, 1 - STEEL[rare == "diffraction"])
    there = rng.random((len(links), len(BETWEEN))) < SHARES[rare in RARELY]
    names = np.array([*BETWEEN])
    lists = [["metal"] if s else names[t].tolist() for s, t in zip(steel, there, strict=True)]
    return [lists[one] for one in number]


def levels(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in a wide hall, girders that differ, shade by links."""
    job = Job(rows, 0, rng)
    shade = job.by_links(lambda n: rng.normal(0.0, 1.1, n) - rng.gamma(1.0, 0.6, n))
    return np.asarray(-60.6 - 18.1 * np.log10(job.far) + GAIN_DB[job.girder] + shade)


def accumulated(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are summed up, and what is told of noise in counts, [n] each."""
    sums = np.asarray(SUMS - rng.binomial(12, 0.3, len(rows)), np.float64)
    own = 1 + 0.04 * GAIN_DB[Job(rows, 0, rng).girder]
    return sums, ROOT_NOISE * np.sqrt(sums) * own * np.exp(rng.normal(0.0, 0.035, len(rows)))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the hangar's own ranges and levels: weak ranges scatter more."""
    level = levels(rows, rng)
    spread = 0.0098 * (1 + 10 ** ((-90.0 - level) / 10))
    error = scatter * spread * rng.standard_t(7.0, len(rows))
    sums, noise = accumulated(rows, rng)
    level = level + rng.normal(0.0, 0.35, len(rows))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.4 - rng.gamma(2.2, 0.45, len(rows)),
        noise_std=noise,
        preamble_count=sums,
    )


def _tolled(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m.

    Draws of one do not depend on others.
    """
    metres = np.zeros((len(drawn.hidden), len(table)))
    first = sorted(name for name in drawn.hidden if name not in LATER)
    for name in (*first, *(name for name in LATER if name in drawn.hidden)):
        rng = np.random.default_rng([1313, seed, side, *name.encode()])
        toll = EFFECTS[name](Job(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = toll.metres
        table = _paid(table, toll)
    return table, metres


def _paid(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table with what its rows get; a first path is some of what is received."""
    first = np.asarray(toll.first_db)
    error = table["error_m"] + toll.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + toll.all_db + 0.45 * first,
        first_path_power_dbm=table["first_path_power_dbm"] + toll.all_db + first,
        noise_std=table["noise_std"] * 10 ** (np.asarray(toll.noise_db) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(toll.sums_db) / 20),
    )
