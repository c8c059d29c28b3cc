"""Carts that drive among poles in a yard: ranges and levels on the move, no CIR.

numpy and pandas alone. Other forms of every effect than in any library or other family: an
arctangent bias of the level, crystals that swing, a bow over temperature, jitter of two sizes, a
loss with a corner, detours from a log-normal law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Law, Tables

Floats = NDArray[np.float64]
POLES_M = ((0, 0, 3.2), (26, 1, 2.9), (24, 19, 3.4), (3, 21, 3.0), (13, -4, 3.1), (12, 24, 2.8))
DRIVES, ROWS, STEP_S = 12, 5, 0.8
SCATTER_M = 0.022
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
    "sagging-supply": "supply_v",
}
RARELY = ("blocked-path",)
LAWS = {
    "pole-elsewhere": Law(("position",), 0.5, "m", devices=("pole3",)),
    "poles-exchanged": Law(("swap",), devices=("pole1", "pole4")),
    "feet-from-one-pole": Law(("unit",), 1 / 0.3048, "1", grows=False, devices=("pole5",)),
    "near-is-long": Law(("inverse", "power", "inverse square")),
    "settles-with-range": Law(("saturation", "logarithm", "power")),
    "sagging-supply": Law(("step", "linear", "power", "saturation")),
    "locks-on-to-the-fence": Law(),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Rows:
    """Rows with ranges and levels to change: `own` seeds what a case keeps, `rng` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    rare: bool = False

    def __getitem__(self, name: str) -> Floats:
        return self.frame[name].to_numpy(np.float64)

    def each(self, end: str, stream: int) -> Floats:
        """Return a number between -1 and 1 that every device keeps in all tables of a case [n]."""
        values = np.random.default_rng([self.own, stream]).uniform(-1, 1, 12)
        shift = 6 if end == "tx" else 0
        return np.asarray(values[self.frame[end].str[4:].astype(int).to_numpy() + shift])

    def ends(self, end: str) -> Floats:
        """Return the positions of one end [n, 3] in metres."""
        return self.frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the yard's own."""
    rng = np.random.default_rng([seed, 21])
    rows = _driven(rng, 6.0 if drawn.same_mix else 4.5)
    clean = _heard(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = _driven(rng, 6.0 if drawn.same_mix else 7.5)
        rows = rows.assign(link="other " + rows["link"])
    parts = [_heard(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(parts, ignore_index=True))


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _driven(np.random.default_rng([seed, 21]), 6.0)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _with(clean, drawn, seed, 22)
    return Tables(recorded, clean, simulated, _with(simulated, drawn, seed, 23)[0], shifts)


def _driven(rng: np.random.Generator, reach_m: float) -> pd.DataFrame:
    """Return what is known of the rows: loops of about `reach_m` around places in the yard."""
    parts = []
    for drive in range(DRIVES):
        middle, start = rng.uniform([7, 4], [19, 16]), rng.uniform(0, 2 * np.pi)
        speed, began = rng.uniform(0.2, 0.6) * rng.choice([-1, 1]), drive * 240.0
        when = np.arange(ROWS) * STEP_S
        for pole, (x, y, z) in enumerate(POLES_M):
            turn = start + speed * (when + 0.1 * pole)
            parts.append(
                pd.DataFrame(
                    {
                        "link": f"d{drive}p{pole}", "tx": f"cart{drive % 2}", "rx": f"pole{pole}",
                        "time_s": began + when + 0.1 * pole,
                        "tx_x_m": middle[0] + reach_m * np.cos(turn),
                        "tx_y_m": middle[1] + reach_m * np.sin(1.3 * turn), "tx_z_m": 0.9,
                        "rx_x_m": float(x), "rx_y_m": float(y), "rx_z_m": z,
                        "azimuth_deg": np.degrees(turn) + 90,
                    }
                )
            )  # fmt: skip
    frame = pd.concat(parts, ignore_index=True)
    gaps = sum((frame[f"tx_{a}_m"] - frame[f"rx_{a}_m"]) ** 2 for a in "xyz")
    drives = frame["link"].str.extract(r"d(\d+)p")[0].astype(int)
    return frame.assign(
        true_range_m=np.sqrt(gaps),
        azimuth_deg=(frame["azimuth_deg"] + 180) % 360 - 180,
        temperature_c=12 + 0.008 * frame["time_s"] + rng.normal(0, 0.2, len(frame)),
        reply_time_s=rng.choice([1e-3, 5e-3, 0.02, 0.05], len(frame)),
        supply_v=rng.uniform(3.0, 3.5, DRIVES)[drives],
    )


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of this yard's own radio."""
    far = rows["true_range_m"].to_numpy(np.float64)
    error = SCATTER_M * scatter * rng.standard_t(6, len(rows)) / np.sqrt(1.5)
    level = -60.5 - 20 * np.log10(far) + rng.normal(0, 0.8, len(rows))
    made = rows.assign(range_m=far + error, error_m=error, rx_power_dbm=level)
    return made.assign(first_path_power_dbm=level - 2 + rng.normal(0, 0.5, len(rows)))


def _with(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    own = int(np.random.default_rng([seed, 24]).integers(2**31))
    rng, shifts = np.random.default_rng([seed, part]), np.zeros((len(drawn.hidden), len(table)))
    for place, name in enumerate(drawn.hidden):
        shifts[place], gain = EFFECTS[name](Rows(table, own, rng, bool(drawn.rare)), drawn.strength)
        error = table["error_m"] + shifts[place]
        table = table.assign(error_m=error, range_m=table["true_range_m"] + error)
        for level in ("rx_power_dbm", "first_path_power_dbm"):
            if level in table:
                table = table.assign(**{level: table[level] + gain})
    return table, shifts


Change = tuple[Floats, Floats | float]


def _speed(rows: Rows) -> Floats:
    """Return the radial speed [n] in m/s: of the true ranges, along each link."""
    frame = rows.frame.assign(key=rows.frame["link"] + " " + rows.frame["time_s"].astype(str))
    paces = [
        pd.Series(np.gradient(link["true_range_m"], link["time_s"]), index=link["key"])
        for _, link in frame.drop_duplicates("key").groupby("link")
    ]
    return np.asarray(frame["key"].map(pd.concat(paces)), np.float64)


def _lag(rows: Rows, strength: float) -> Change:
    return 0.06 * strength * _speed(rows), 0.0


def _moving(rows: Rows, strength: float) -> Change:
    return min(strength, 1.0) * rows["reply_time_s"] * _speed(rows), 0.0


def _delays(rows: Rows, strength: float) -> Change:
    return 0.11 * strength * (rows.each("tx", 1) + rows.each("rx", 1) + 0.6), 0.0


def _swinging(rows: Rows, strength: float) -> Change:
    swing = 1 + 0.1 * np.sin(rows["time_s"] / 900)
    ppm = 0.06 * strength * swing * (rows.each("tx", 2) - rows.each("rx", 2))
    return 149.9 * ppm * rows["reply_time_s"], 0.0


def _bow(rows: Rows, strength: float) -> Change:
    warm = rows["temperature_c"] - 25
    return 0.005 * strength * warm * (1 + 0.01 * warm), 0.0


def _cardioid(rows: Rows, strength: float) -> Change:
    turn = np.radians(rows["azimuth_deg"]) - np.pi * rows.own / 2**30
    return 0.07 * strength * (np.cos(turn) + 0.5 * np.abs(np.cos(turn)) - 0.32), 0.0


def _arctangent(rows: Rows, strength: float) -> Change:
    return -0.07 * strength * np.arctan((rows["rx_power_dbm"] + 83) / 3), 0.0


def _two_sizes(rows: Rows, strength: float) -> Change:
    size = np.where(rows.rng.random(len(rows.frame)) < 0.15, 3.0, 0.7)
    return 0.035 * strength * size * rows.rng.normal(size=len(size)), 0.0


def _corner(rows: Rows, strength: float) -> Change:
    over = np.maximum(np.log10(rows["true_range_m"] / 6), 0)
    return np.zeros(len(over)), -12 * strength * over


def _stretched(rows: Rows, strength: float) -> Change:
    return rows["true_range_m"] * (1 / (1 - 0.005 * strength) - 1), 0.0


def _grid(rows: Rows, strength: float) -> Change:
    step = 0.16 * strength
    return step * np.round(rows["range_m"] / step) - rows["range_m"], 0.0


def _struck(rows: Rows, strength: float) -> Change:
    codes, links = pd.factorize(rows.frame["link"])
    hit = rows.rng.random(len(links)) < (0.06 if rows.rare else 0.2)
    detour = hit * rows.rng.lognormal(np.log(0.8 * max(strength, 0.7)), 0.5, len(links))
    return detour[codes], np.where(hit[codes], -7.0, 0.0)


def _real(rows: Rows, real: Floats) -> Change:
    gone = np.linalg.norm(rows.ends("tx") - real, axis=1)
    return np.asarray(gone - rows["true_range_m"]), 0.0


def _elsewhere(rows: Rows, strength: float) -> Change:
    mine = (rows.frame["rx"] == "pole3").to_numpy()[:, None]
    return _real(rows, rows.ends("rx") + mine * np.array([-0.3, 0.4, 0.0]) * strength)


def _exchanged(rows: Rows, _: float) -> Change:
    real, who = rows.ends("rx"), rows.frame["rx"].to_numpy()
    real[who == "pole1"], real[who == "pole4"] = POLES_M[4], POLES_M[1]
    return _real(rows, real)


def _feet(rows: Rows, _: float) -> Change:
    mine = (rows.frame["rx"] == "pole5").to_numpy()
    return mine * (1 / 0.3048 - 1) * rows["range_m"], 0.0


def _near(rows: Rows, strength: float) -> Change:
    return 1.2 * strength / np.maximum(rows["true_range_m"], 2.0), 0.0


def _settling(rows: Rows, strength: float) -> Change:
    return 0.3 * strength * (1 - np.exp(-rows["true_range_m"] / 6)), 0.0


def _sagging(rows: Rows, strength: float) -> Change:
    return 0.9 * strength * np.maximum(3.25 - rows["supply_v"], 0), 0.0


def _fence(rows: Rows, strength: float) -> Change:
    locked = rows.rng.random(len(rows.frame)) < 0.3
    return locked * strength * rows.rng.uniform(0.3, 0.5, len(locked)), 0.0


EFFECTS: dict[str, Callable[[Rows, float], Change]] = {
    "time-lag": _lag,
    "exchange-motion": _moving,
    "antenna-delay": _delays,
    "clock-offset": _swinging,
    "temperature-drift": _bow,
    "antenna-pattern": _cardioid,
    "power-bias": _arctangent,
    "timestamp-jitter": _two_sizes,
    "path-loss": _corner,
    "range-scale": _stretched,
    "range-rounding": _grid,
    "blocked-path": _struck,
    "pole-elsewhere": _elsewhere,
    "poles-exchanged": _exchanged,
    "feet-from-one-pole": _feet,
    "near-is-long": _near,
    "settles-with-range": _settling,
    "sagging-supply": _sagging,
    "locks-on-to-the-fence": _fence,
}
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
