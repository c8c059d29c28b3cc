"""Chairs of a lift and groomers on its piste, ranged from pylons: ranges and levels.

numpy and pandas alone; what it can hide is in `chairlift_effects`, waveforms in `chairlift_waves`.
No room is known, and no line of sight; the channel is. Four pylons in turn hear a tag go by.
"""

from __future__ import annotations

from itertools import chain

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.chairlift_effects import EFFECTS
from bench.challenge.families.chairlift_rope import (
    CHAIRS,
    DAY_S,
    GROOMERS,
    LAWS,
    LEFT_IN,
    PYLONS_M,
    SIDE_M,
    TAGS,
    WAY,
    Ill,
    Trip,
    over_spans,
    whereabouts,
)

Floats = NDArray[np.float64]
Ids = NDArray[np.int32]
LENGTHS = {1: 12, 2: 11, 3: 11, 4: 11, 5: 11, 6: 10, 7: 10, 8: 10, 9: 9, 10: 9}
"""How many links have so many rows."""
BY, GROOMED, STOPS = 4, 9, (5, 2)  # pylons of a trip; trips of groomers; chairs and they that stop
TURN_S, NEXT_S = 0.27, 0.023  # from turn to turn, from pylon to pylon
SHEAVES = 0.17  # of links that meet sheaves
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = dict(
    chain(
        ((one, "true_range_m") for one in ("path-loss", "level-control", "power-bias")),
        ((one, "reply_time_s") for one in ("exchange-motion", "clock-offset")),
        ((one, "time_s") for one in ("antenna-delay", "time-lag")),
        (("range-scale", "true_range_m"), ("temperature-drift", "temperature_c")),
        (("antenna-pattern", "azimuth_deg"), ("rime-on-radomes", "rime_mm")),
        (("snow-on-seats", "snow_kg"), ("wheel-out-of-round", "rope_m")),
        (("snow-guns-on", "gun_bar"), ("salt-on-hangers", "salt_g")),
        (("fog-thickens", "sight_m"), ("grease-stiffens", "grease_um")),
        (("chairs-blown-aside", "wind_mps"),),
    )
)
RARELY = ("material-delay", "blocked-path")
FINALLY = ("lead-in-the-filter", "klafters-from-one-pylon", "range-rounding")  # in this order
COUNTS: Floats = np.array([1010.0] + 9 * [506.0] + [1010.0])  # symbols by pylon; stations take more
FLOOR: Floats = np.array([2.9, 3.4, 3.1, 3.6, 3.3, 3.0, 3.5, 3.2, 3.7, 3.4, 2.8])
"""Noise in counts for each root of a symbol."""
BETTER_DB: Floats = np.array([1.1, -0.3, 0.4, -0.9, 0.2, -1.2, 0.7, -0.5, 0.9, -0.1, 1.3])


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the chairlift's own."""
    rng = np.random.default_rng([1220, seed, 0])
    here = mixed(trips(rng, drawn.rare), drawn, lower=True)
    clean = _measured(here, rng, drawn.scatter)
    there = here
    if not drawn.paired:
        there = mixed(trips(rng, drawn.rare), drawn, lower=False)
        there["link"] = "day after: " + there["link"]
    again = pd.concat([there] * drawn.ratio).reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _measured(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return trips(np.random.default_rng([1220, seed, 0]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    ailing, metres = _ailing(clean, drawn, seed, "here")
    truth = _ailing(simulated, drawn, seed, "true")[0]
    listed = drawn.listed
    return Tables(
        public(ailing, listed), public(clean, listed), public(simulated, listed),
        public(truth, listed), metres,
    )  # fmt: skip


def public(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without ways, and without what these meet where it is not listed."""
    secret = {*WAY} if listed else {*WAY, "obstacles"}
    return table.loc[:, [name not in secret for name in table]]


def mixed(rows: pd.DataFrame, drawn: Draw, lower: bool) -> pd.DataFrame:
    """Return all rows, or where mixes are to differ more short links (lower), or more long ones.

    Of the shorter, or the longer, five eighths all, of the rest every fifth.
    """
    if drawn.same_mix:
        return rows
    long = rows.groupby("link")["true_range_m"].median()
    names = long.sort_values(ascending=lower).index.to_list()
    begin = 5 * len(names) // 8
    some = {*names[:begin], *names[begin::5]}
    return rows[[name in some for name in rows["link"]]].reset_index(drop=True)


def trips(
    rng: np.random.Generator, rare: str, lengths: dict[int, int] | None = None
) -> pd.DataFrame:
    """Return what is known of the rows of a day: trips, some of tags that stop."""
    lengths = lengths or LENGTHS
    rows = rng.permutation([n for n, links in lengths.items() for _ in range(links)])
    begin = DAY_S * np.sort(rng.random(len(rows) // BY))
    rides = rng.permutation(len(begin)) >= GROOMED
    stops = np.zeros(len(begin), bool)
    for kind, count in zip((True, False), STOPS, strict=True):
        stops[rng.choice(np.flatnonzero(rides == kind), count, replace=False)] = True
    parts = []
    for k, four in enumerate(np.split(rows, len(begin))):
        trip = _trip(rng, k, four, bool(rides[k]), bool(stops[k]))
        gauges = _gauges(rng, len(trip), float(begin[k]) / DAY_S)
        parts.append(trip.assign(time_s=trip["tick_s"] + begin[k], **gauges))
    table = pd.concat(parts, ignore_index=True).assign(channel=3, prf_mhz=16.0)
    table["obstacles"] = _met(rng, table["link"], rare)
    return table


def _trip(
    rng: np.random.Generator, number: int, rows: Ids, rides: bool, stops: bool
) -> pd.DataFrame:
    """Return one trip: pylons hear a tag so often each, from some turn on."""
    late = rng.integers(0, 4, BY)
    turn = np.concatenate([late[k] + np.arange(rows[k]) for k in range(BY)])
    slot = np.repeat(np.arange(BY), rows)
    way = _way(rng, rides, stops)
    frame = pd.DataFrame(way, index=range(len(slot))).assign(tick_s=TURN_S * turn + NEXT_S * slot)
    ways = {name: frame[name].to_numpy(np.float64) for name in WAY}
    seat = whereabouts(ways, ways["tick_s"])
    pylon = _near(rng, seat.mean(axis=0))[slot]
    ends = np.hstack([seat, PYLONS_M[pylon]])
    frame[[f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"]] = ends
    line = ends[:, 3:] - seat
    ahead = (0.0 if way["pace_mps"] >= 0 else np.pi) + rng.normal(0.0, 0.5)
    bearing = np.arctan2(line[:, 1], line[:, 0]) - ahead
    return frame.assign(
        tx=TAGS[rng.integers(CHAIRS) if rides else CHAIRS + rng.integers(GROOMERS)],
        rx=[f"pylon{one}" for one in pylon],
        link=[f"trip {number} by pylon {one}" for one in pylon],
        environment="line" if rides else "piste",
        true_range_m=np.sqrt((line**2).sum(axis=1)),
        azimuth_deg=np.mod(np.degrees(bearing), 360.0),
        rope_m=rng.uniform(0.0, 240.0) + seat[:, 0],
    )


def _way(rng: np.random.Generator, rides: bool, stops: bool) -> dict[str, float]:
    """Return how a tag goes on a trip."""
    up = rng.choice((-1.0, 1.0))
    pace = rng.uniform(1.3, 2.6) if rides else rng.uniform(0.9, 2.1)
    goes = 0.0 if stops else 1.0
    return {
        "rides": float(rides),
        "from_m": rng.uniform(14.0, 108.0),
        "pace_mps": goes * up * pace,
        "gains_mps2": goes * rng.normal(0.0, 0.12),
        "lane_m": up * SIDE_M if rides else -rng.uniform(8.0, 21.0),
        "swing_m": goes * rng.gamma(4.0, 0.04),
        "beat": rng.normal(1.95, 0.06) if rides else rng.uniform(0.3, 0.5),
        "phase": rng.uniform(-np.pi, np.pi),
    }


def _near(rng: np.random.Generator, seat: Floats) -> Ids:
    """Return which pylons hear a tag [BY]: four of the seven that are nearest along the line."""
    order = np.argsort(np.abs(PYLONS_M[:, 0] - seat[0]) + 0.01 * np.arange(len(PYLONS_M)))
    return rng.choice(order[:7], BY, replace=False).astype(np.int32)


def _gauges(rng: np.random.Generator, size: int, part: float) -> dict[str, Floats]:
    """Return what a trip's rows log, so far into a day: it thaws toward noon."""
    warm = -9.0 + 9.0 * np.sin(np.pi * part) + rng.normal(0.0, 2.6)
    return {
        "temperature_c": warm + rng.normal(0.0, 0.8, size),
        "reply_time_s": rng.gamma(5.0, 0.0042, size).clip(0.004, 0.06),
        "rime_mm": np.abs(rng.normal(0.0, 4.5) + rng.normal(0.0, 2.2, size)).clip(max=11.0),
        "snow_kg": rng.gamma(1.2, 4.0) + rng.gamma(1.3, 2.5, size),
        "gun_bar": (rng.uniform(4.0, 40.0) + rng.normal(0.0, 6.0, size)).clip(0.0, 44.0),
        "salt_g": rng.lognormal(0.8, 0.9) * rng.lognormal(0.0, 0.6, size),
        "sight_m": 14.0 + 150.0 * rng.beta(0.8, 1.9) * rng.uniform(0.5, 1.5, size),
        "grease_um": rng.uniform(0.0, 18.0) + rng.gamma(3.0, 1.6, size),
        "wind_mps": np.abs(rng.normal(5.0, 4.0) + rng.normal(0.0, 1.2, size)).clip(max=15.0),
    }


def _met(rng: np.random.Generator, links: pd.Series, rare: str) -> list[list[str]]:
    """Return what straight paths meet: sheaves of steel on some links, wood and glass on others."""
    codes, names = pd.factorize(links)
    share = 0.035 if rare in RARELY else 0.15
    order = rng.permutation(len(names))
    met: list[list[str]] = [[] for _ in names]
    for link in order:
        some = rng.random(len(LEFT_IN)) < share
        met[link] = [kind for kind, there in zip(LEFT_IN, some, strict=True) if there]
    for link in order[: round(SHEAVES * len(names))]:
        met[link] = ["metal"]
    return [met[code] for code in codes]


def up_the_line(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in the open; hangers and heads of pylons shade by links."""
    trip = Trip(rows, 0, rng)
    amid = over_spans(trip.seat[:, 0])[1]  # low amid spans, where less shades
    shade = trip.for_links(lambda n: 0.9 - rng.gamma(2.2, 0.45, n)) * (1.25 - 0.5 * amid)
    return np.asarray(-60.1 - 19.4 * np.log10(trip.long) + BETTER_DB[trip.pylon] + shade)


def taken(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are taken, and what is read of noise in counts, [n] each."""
    pylon = Trip(rows, 0, rng).pylon
    counts = COUNTS[pylon] - 2.0 * rng.geometric(0.4, len(pylon))
    read = rng.gamma(900.0, 1 / 900.0, len(pylon))
    return counts, FLOOR[pylon] * np.sqrt(COUNTS[pylon]) * read


def _measured(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the chairlift's own ranges and levels.

    Ranges scatter by Laplace's law, on some links more than on others.
    """
    rough = Trip(rows, 0, rng).for_links(lambda n: rng.uniform(0.55, 1.35, n))
    error = 0.0098 * scatter * rough * rng.laplace(0.0, 1.0, len(rows))
    level = up_the_line(rows, rng) + rng.laplace(0.0, 0.22, len(rows))
    counts, noise = taken(rows, rng)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.35 - rng.lognormal(-0.1, 0.6, len(rows)).clip(max=8.0),
        noise_std=noise,
        preamble_count=counts,
    )


def _ailing(table: pd.DataFrame, drawn: Draw, seed: int, side: str) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    rest = sorted(name for name in drawn.hidden if name not in FINALLY)
    for name in (*rest, *(name for name in FINALLY if name in drawn.hidden)):
        own = np.random.default_rng([1222, seed, *f"{side} {name}".encode()])
        ill = EFFECTS[name](Trip(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = ill.get("metres", 0.0)
        table = _ill(table, ill)
    return table, metres


def _ill(table: pd.DataFrame, ill: Ill) -> pd.DataFrame:
    """Return the table with what ails its rows."""
    metres, level, first, noise, sums = (
        np.asarray(ill.get(one, 0.0)) for one in ("metres", "level", "first", "noise", "sums")
    )
    table = table.assign(error_m=table["error_m"] + metres)
    return table.assign(
        range_m=table["true_range_m"] + table["error_m"],
        rx_power_dbm=table["rx_power_dbm"] + level + 0.55 * first,
        first_path_power_dbm=table["first_path_power_dbm"] + level + first,
        noise_std=table["noise_std"] * np.power(10.0, noise / 20),
        preamble_count=table["preamble_count"] * np.power(10.0, sums / 20),
    )
