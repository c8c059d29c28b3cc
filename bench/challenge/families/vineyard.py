"""Tractors and pickers' baskets among vines, ranged from stakes and tractors: ranges and levels.

numpy and pandas alone; what it can hide is in `vineyard_effects`, waveforms in `vineyard_waves`. No
room is known, but the channel is. A pass up or down an alley has from one to eleven calls, which
nine stakes and a tractor answer now and then.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.vineyard_effects import EFFECTS
from bench.challenge.families.vineyard_slope import (
    ALLEY_M,
    BASKETS,
    CRATES,
    DAY_S,
    DEVICES,
    GAIT,
    LAWS,
    MOTION,
    PLOT_M,
    STAKES,
    STAKES_M,
    TRACTORS,
    Blight,
    Harvest,
    gone,
    name_of,
)

Floats = NDArray[np.float64]
CALLS = (1, 2, 3, 3, 4, 5, 6, 7, 8, 9, 11)  # of passes, in any order
HEARD_BY = 10  # receivers of a pass, the last of them a tractor
ANSWER_S, ANSWERED = 0.013, 0.78  # from one receiver to the next; share of calls
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
    "must-on-lids": "must_g",
    "leaves-wilt": "leaf_bar",
    "trellis-stays-passed": "row_m",
    "hail-net-wets": "humidity_percent",
    "baskets-heaped": "grapes_kg",
    "sulphur-on-foils": "sulphur_g",
    "stakes-in-moist-soil": "soil_kpa",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
WRITTEN = ("pieds-from-one-stake", "range-rounding")  # of what is shown, in this order
TRAILERS = {False: 0.16, True: 0.05}  # of links with a trailer in the way, and where these are rare
OWN_DB = np.array([-0.7, 0.5, 1.1, -0.2, 0.8, -1.2, 0.3, -0.5, 0.1, 0.6, -1.4, 0.9, -0.4])
"""What receiving devices hear more of: stakes, then tractors."""
SYMBOLS = np.array([506.0] * STAKES + [250.0] * TRACTORS)
HISS = np.array([3.05, 3.2, 2.95, 3.1, 3.3, 2.9, 3.15, 3.0, 3.25, 3.08, 3.6, 3.75, 3.5])
"""Their noise in counts, for each root of a symbol."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the vineyard's own."""
    rng = np.random.default_rng([1130, seed])
    here = mixed(passes(rng, drawn.rare), drawn, "lower")
    clean = _ranged(here, rng, drawn.scatter)
    if not drawn.paired:
        here = mixed(passes(rng, drawn.rare), drawn, "upper")
        here["link"] = "next slope: " + here["link"]
    again = pd.concat(drawn.ratio * [here], ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return passes(np.random.default_rng([1130, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _blighted(clean, drawn, seed, 0)
    truth, _ = _blighted(simulated, drawn, seed, 1)
    four = [shown(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3], metres)


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without gaits, and without what stands between unless it is listed."""
    private = set(MOTION) if listed else {*MOTION, "obstacles"}
    return table[[name for name in table if name not in private]]


def mixed(rows: pd.DataFrame, drawn: Draw, half: str) -> pd.DataFrame:
    """Return all rows, or where the mix is to differ mostly near links (`lower`) or far ones.

    Of the nearer or farther half of the links all, of the others every sixth.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link", sort=False)["true_range_m"].mean().sort_values()
    order = np.arange(len(far)) if half == "lower" else np.arange(len(far))[::-1]
    kept = far.index[(order < len(far) // 2) | (order % 6 == 3)]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def passes(rng: np.random.Generator, rare: str, calls: tuple[int, ...] = CALLS) -> pd.DataFrame:
    """Return what is known of the rows of a day: passes, in four of which nobody moves."""
    many = rng.permutation(calls)
    begin_s = np.sort(rng.uniform(0.0, DAY_S, len(many)))
    drives = rng.permutation(np.arange(len(many)) % 2 == 0)  # else it is a picker who walks
    rests = np.zeros(len(many), bool)
    for kind in (False, True):
        rests[rng.permutation(np.flatnonzero(drives == kind))[:2]] = True
    if rare == "exchange-motion":  # one pass of two calls and one of three alone
        rests = ~np.isin(np.arange(len(many)), [np.argmax(many == 2), np.argmax(many == 3)])
        drives = drives | ~rests
    callers = np.zeros(len(many), np.intp)  # each as often as others of its kind
    callers[drives] = STAKES + np.resize(rng.permutation(TRACTORS), drives.sum())
    callers[~drives] = STAKES + TRACTORS + np.resize(rng.permutation(BASKETS), (~drives).sum())
    made = [
        _pass(rng, k, int(many[k]), float(begin_s[k]), int(callers[k]), bool(rests[k]))
        for k in range(len(many))
    ]
    table = pd.concat(made, ignore_index=True)
    return table.assign(obstacles=_in_alleys(rng, table["link"], TRAILERS[rare == "diffraction"]))


def _pass(
    rng: np.random.Generator, number: int, calls: int, begin_s: float, caller: int, rests: bool
) -> pd.DataFrame:
    """Return one pass: a tag calls, and most receivers answer, one after the other."""
    gaits, starts = _gaits(rng, rests), _starts(rng)
    ears = _ears(rng, starts, caller)
    answers = rng.random((calls, HEARD_BY)) < ANSWERED
    answers[rng.integers(calls, size=HEARD_BY), np.arange(HEARD_BY)] = True  # once at least
    call, slot = answers.nonzero()
    since = rng.uniform(0.4, 0.75, calls).cumsum()[call] + ANSWER_S * slot
    ends = (("tx", np.full(len(slot), caller)), ("rx", ears[slot]))
    table = pd.concat([_end(end, who, since, starts, gaits) for end, who in ends], axis=1)
    way = np.stack([table[f"rx_{axis}_m"] - table[f"tx_{axis}_m"] for axis in "xyz"], axis=1)
    ahead = np.where(gaits["pace_m_per_s"][caller] < 0, -np.pi / 2, np.pi / 2)
    askew = rng.normal(0.0, 0.35)  # how a cab or a back is turned in its alley
    return table.assign(
        **_book(rng, len(slot), begin_s),
        row_m=table["tx_y_m"] + rng.uniform(0.5, 6.5),  # rows begin askew below the track
        true_range_m=np.linalg.norm(way, axis=1),
        azimuth_deg=np.degrees(np.arctan2(way[:, 1], way[:, 0]) - ahead - askew) % 360,
        link=f"pass {number} heard by " + table["rx"].str.replace(r"(\d)", r" \1", regex=True),
        environment="upper half" if starts[caller, 1] > PLOT_M[1] / 2 else "lower half",
        since_s=since,
        time_s=begin_s + since,
        channel=4,
        prf_mhz=16.0,
    )


def _gaits(rng: np.random.Generator, rests: bool) -> pd.DataFrame:
    """Return how all devices go [DEVICES], GAIT of each: tractors steadily, pickers in spurts."""
    gaits = pd.DataFrame(0.0, index=range(DEVICES), columns=list(GAIT))
    if rests:
        return gaits
    for device in range(STAKES, DEVICES):
        drives = device < STAKES + TRACTORS
        pace = rng.uniform(0.8, 1.7) if drives else rng.uniform(0.25, 0.6)
        rate = rng.uniform(0.5, 0.9)
        gaits.loc[device] = [
            pace * rng.choice((-1, 1)),
            (0.12 if drives else 0.8) * pace / rate,
            rate,
            rng.uniform(0.0, 2 * np.pi),
            rng.uniform(0.05, 0.16) if drives else rng.uniform(0.1, 0.3),
            rng.uniform(0.02, 0.06) if drives else rng.uniform(0.01, 0.04),
        ]
    return gaits


def _starts(rng: np.random.Generator) -> Floats:
    """Return where devices are when a pass begins [DEVICES, 3]: each tag in an alley of its own."""
    alleys = rng.permutation(np.arange(1, 21))[: TRACTORS + BASKETS]
    up = rng.uniform(0.25, 0.75, TRACTORS + BASKETS) * PLOT_M[1]
    high = np.r_[rng.uniform(2.4, 2.9, TRACTORS), rng.uniform(1.05, 1.55, BASKETS)]
    beside = rng.uniform(-0.25, 0.25, TRACTORS + BASKETS)
    return np.vstack([STAKES_M, np.stack([ALLEY_M * alleys + beside, up, high], axis=1)])


def _ears(rng: np.random.Generator, starts: Floats, caller: int) -> NDArray[np.intp]:
    """Return who hears a caller [HEARD_BY]: all stakes but a far one, and a tractor."""
    far = np.linalg.norm(STAKES_M - starts[caller], axis=1) + rng.exponential(6.0, STAKES)
    others = [k for k in range(STAKES, STAKES + TRACTORS) if k != caller]
    return np.append(np.sort(np.argsort(far)[: HEARD_BY - 1]), rng.choice(others)).astype(np.intp)


def _end(
    end: str, device: NDArray[np.intp], since: Floats, starts: Floats, gaits: pd.DataFrame
) -> pd.DataFrame:
    """Return where devices [n] are at times [n] in s, how they go, and what they are called."""
    own = gaits.iloc[device].reset_index(drop=True)
    x, y, z = (starts[device] + gone(own, since)).T
    called = [name_of(int(one)) for one in device]
    places = {end: called, f"{end}_x_m": x, f"{end}_y_m": y, f"{end}_z_m": z}
    return own.rename(columns=lambda name: f"{end}_{name}").assign(**places)


def _book(rng: np.random.Generator, size: int, begin_s: float) -> dict[str, Floats]:
    """Return what sensors read, for each row: it warms and dries from before dawn on."""
    day = begin_s / DAY_S
    warm = 5.0 + 19.0 * day**1.5 + rng.normal(0.0, 2.5)
    damp = 97.0 - 22.0 * day + rng.normal(0.0, 4.0)
    return {
        "temperature_c": warm + rng.normal(0.0, 1.1, size),
        "reply_time_s": np.clip(rng.lognormal(np.log(0.021), 0.6, size), 0.005, 0.085),
        "must_g": rng.gamma(1.3, 2.8) + rng.gamma(1.5, 1.6, size),
        "leaf_bar": 3.0 + 8.0 * day * rng.uniform(0.7, 1.3) + rng.gamma(2.0, 0.8, size),
        "humidity_percent": np.clip(damp + rng.normal(0.0, 5.0, size), 30.0, 100.0),
        "grapes_kg": np.clip(rng.uniform(0.0, 26.0) + rng.normal(0.0, 4.0, size), 0.0, 32.0),
        "sulphur_g": rng.weibull(1.2) * 3.0 + rng.exponential(2.0, size),
        "soil_kpa": 11.0 + 45.0 * rng.beta(1.3, 1.8) + rng.gamma(2.0, 3.5, size),
    }


def _in_alleys(rng: np.random.Generator, links: pd.Series, trailers: float) -> pd.Series:
    """Return what stands in straight paths: a steel trailer, crates and walls, or nothing."""
    made: dict[str, list[str]] = {}
    for link in links.unique():
        steel, *others = rng.random(1 + len(CRATES))
        some = [kind for kind, u in zip(CRATES, others, strict=True) if u < 0.16]
        made[link] = ["metal"] if steel < trailers else some
    return links.map(made)


def through_leaves(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, less what leaves take [n]."""
    harvest = Harvest(rows, 0, np.random.default_rng(0))
    taken = 4.2 * -np.expm1(-harvest.leaves / 3.5)
    return np.asarray(-57.9 - 19.2 * np.log10(harvest.metres) - taken + OWN_DB[harvest.hears])


def counted_by(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is reported of noise in counts, [n] each."""
    ear = Harvest(rows, 0, rng).hears
    symbols = SYMBOLS[ear] - rng.integers(0, 9, len(ear))
    spread = 1.0 + 0.03 * rng.standard_normal(len(ear))
    return symbols.astype(np.float64), HISS[ear] * np.sqrt(SYMBOLS[ear]) * spread


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the vineyard's own radio."""
    size, (link, names) = len(rows), pd.factorize(rows["link"])
    canes = 1.1 * (1.5 - rng.gamma(1.5, 1.0, len(names)))  # some links meet many of them
    level = through_leaves(rows) + canes[link] + 10 * np.log10(rng.gamma(45.0, 1 / 45.0, size))
    late = rng.gumbel(0.0, 1.0, size) - np.euler_gamma  # seldom early by much
    error = scatter * 0.0142 * late
    symbols, noise = counted_by(rows, rng)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.45 - 4.0 * rng.beta(1.5, 4.5, size),
        noise_std=noise,
        preamble_count=symbols,
    )


def _blighted(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m.

    Each draws from a stream of its own, whatever else is hidden.
    """
    metres = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: (one in WRITTEN, one == WRITTEN[-1])):
        rng = np.random.default_rng([1132, side, list(EFFECTS).index(name), seed])
        blight = EFFECTS[name](Harvest(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = blight.metres
        table = _bearing(table, blight)
    return table, metres


def _bearing(table: pd.DataFrame, blight: Blight) -> pd.DataFrame:
    """Return the table with what befalls its rows."""
    out = table.copy()
    out["error_m"] = table["error_m"] + blight.metres
    out["range_m"] = table["true_range_m"] + out["error_m"]
    out["rx_power_dbm"] = table["rx_power_dbm"] + blight.whole + 0.5 * np.asarray(blight.first)
    out["first_path_power_dbm"] = table["first_path_power_dbm"] + blight.whole + blight.first
    out["noise_std"] = table["noise_std"] * 10.0 ** (np.asarray(blight.hiss) / 20)
    out["preamble_count"] = table["preamble_count"] * 10.0 ** (np.asarray(blight.fewer) / 20)
    return out
