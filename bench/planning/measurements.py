"""Measurements that a user can make: one thing changed at a time from what was recorded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bench.discrepancy.data.covariates import MEASURED
from bench.physics.base import Base
from bench.physics.scene import OBSTACLE_LISTS
from bench.planning.settings import (
    DISTANCES_M,
    FARTHER,
    FARTHEST_LEAST_M,
    FULL_TURN_DEG,
    HEIGHTS_M,
    LESS_POWER_DB,
    REPEATS,
    REPLIES,
    REPLY_S,
    SPEEDS_M_PER_S,
    SWITCHED_ON_S,
    TEMPERATURES_C,
)
from bench.recordings.motion import SPEED

REPEAT, WALL = "repeat", "brick"


@dataclass(frozen=True)
class Measurement:
    """One thing to measure: which `knob` is turned, in `words`, and the columns that says.

    `around`: the antenna is turned by equal steps from row to row, once around.
    """

    knob: str
    words: str
    settings: dict[str, Any]
    around: bool = False

    def rows(self, reference: pd.Series, rows: int, link: str) -> pd.DataFrame:
        """Return the rows of one link so measured, all else as in a recorded row."""
        settings = dict(self.settings)
        if "obstacles" in settings:  # of new obstacles nothing more is known
            unknown = [np.nan] * len(settings["obstacles"])
            settings |= {name: unknown for name in OBSTACLE_LISTS if name in reference}
        if "true_range_m" in settings:
            settings = {**_moved(reference, settings["true_range_m"]), **settings}
        one: dict[str, Any] = {str(name): cell for name, cell in reference.items()}
        one |= {**settings, "link": link}
        made = pd.DataFrame([one] * rows)
        turned = {"azimuth_deg": FULL_TURN_DEG * np.arange(rows) / rows}
        return made.assign(**turned) if self.around else made


def reference_row(frame: pd.DataFrame) -> pd.Series:
    """Return what is known of the row nearest to the median of all numbers: what is typical."""
    numbers = frame.select_dtypes("number").astype(np.float64)
    spread = numbers.std().replace(0, np.nan)
    far = ((numbers - numbers.median()) / spread).abs().sum(axis=1)
    if "obstacles" in frame:
        listed = frame["obstacles"].map(lambda cell: len(_listed(cell)))
        far = far + (listed != listed.mode().iloc[0]) * far.max()
    known = [name for name in frame if name not in MEASURED]
    return frame[known].iloc[int(np.argmin(far.to_numpy()))]


def measurements(frame: pd.DataFrame, base: Base) -> tuple[Measurement, ...]:
    """Return everything offered for these recordings; what nothing reacts to sorts itself out.

    The first are repeats of what was recorded: by how much they differ is chance.
    """
    site = Site(frame, reference_row(frame), base)
    made = [Measurement(REPEAT, "as recorded, on new links", {})] * REPEATS
    for offer in (_distances, _walls, _replies, _powers, _headings, _warmth, _speeds, _devices,
                  _heights):  # fmt: skip
        made += list(offer(site))
    return tuple(made)


@dataclass(frozen=True)
class Site:
    """What was recorded: all rows, a typical one, and the radio settings."""

    frame: pd.DataFrame
    typical: pd.Series
    base: Base


Offers = Iterator[Measurement]


def _distances(site: Site) -> Offers:
    longest = float(site.frame["true_range_m"].max())
    placed = {"tx_x_m", "rx_x_m"} <= set(site.frame)  # in a hall, whose size they show
    limit = longest if placed else max(FARTHER * longest, FARTHEST_LEAST_M)
    for distance in DISTANCES_M:
        if distance <= limit:
            yield Measurement("distance", f"{distance:g} m apart", {"true_range_m": distance})


def _walls(site: Site) -> Offers:
    kind = _commonest(site.frame)
    for count, words in enumerate(("nothing between", f"{kind} between", f"two of {kind} between")):
        known: dict[str, Any] = {"obstacles": [kind] * count}
        if "los" in site.frame:
            known["los"] = float(count == 0)
        yield Measurement("walls", words, known)


def _commonest(frame: pd.DataFrame) -> str:
    """Return the obstacle that the recordings have most."""
    cells = frame.get("obstacles", ())
    kinds = pd.Series([kind for cell in cells for kind in _listed(cell)], dtype=object)
    return str(kinds.mode().iloc[0]) if len(kinds) else WALL


def _listed(cell: Any) -> list[str]:
    return list(cell) if isinstance(cell, list | tuple | np.ndarray) else []


def _replies(site: Site) -> Offers:
    now = float(site.typical.get("reply_time_s", np.nan))
    longest = max(now, REPLY_S[1])
    wanted = [float(np.clip(now * factor, REPLY_S[0], longest)) for factor in REPLIES]
    for reply in dict.fromkeys(wanted) if np.isfinite(now) and now > 0 else ():
        if reply == now:
            continue
        words = f"reply time {reply * 1e3:.3g} ms instead of {now * 1e3:.3g} ms"
        yield Measurement("reply time", words, {"reply_time_s": reply})


def _powers(site: Site) -> Offers:
    now = float(site.typical.get("tx_power_dbm", np.nan))
    now = now if np.isfinite(now) else site.base.tx_power_dbm
    for less in LESS_POWER_DB:
        words = f"{less:g} dB less transmit power ({now - less:g} dBm)"
        yield Measurement("transmit power", words, {"tx_power_dbm": now - less})


def _headings(site: Site) -> Offers:
    # Single headings would leave a pattern and a difference between links alike.
    if "azimuth_deg" in site.frame:
        words = "antenna turned once around, by equal steps from row to row"
        yield Measurement("heading", words, {}, around=True)


def _warmth(site: Site) -> Offers:
    for degrees in TEMPERATURES_C if "temperature_c" in site.frame else ():
        words = f"devices at {degrees:g} degrees C"
        yield Measurement("temperature", words, {"temperature_c": degrees})
    for since in SWITCHED_ON_S if "time_s" in site.frame else ():
        words = f"{since / 60:g} min into a session, devices switched on at its start"
        yield Measurement("warm-up", words, {"time_s": since})


def _speeds(site: Site) -> Offers:
    for speed in SPEEDS_M_PER_S if SPEED in site.frame else ():
        way = "apart" if speed > 0 else "nearer"
        words = f"moving {way} at {abs(speed):g} m/s" if speed else "standing still"
        yield Measurement("speed", words, {SPEED: speed})


def _devices(site: Site) -> Offers:
    if {"tx", "rx"} <= set(site.frame):
        swapped = {"tx": site.typical["rx"], "rx": site.typical["tx"]}
        words = f"roles swapped: {swapped['tx']} begins, {swapped['rx']} answers"
        yield Measurement("devices", words, swapped)
        for other in sorted(set(site.frame["tx"].astype(str)) - {str(site.typical["tx"])})[:2]:
            yield Measurement("devices", f"{other} instead of {site.typical['tx']}", {"tx": other})


def _heights(site: Site) -> Offers:
    for height in HEIGHTS_M if {"tx_z_m", "rx_z_m"} <= set(site.frame) else ():
        both = {"tx_z_m": height, "rx_z_m": height}
        yield Measurement("height", f"both antennas {height:g} m above the floor", both)


def _moved(known: pd.Series, distance_m: float) -> dict[str, float]:
    """Return the transmitter's position at another distance on the same line, where known."""
    axes = [axis for axis in "xyz" if {f"tx_{axis}_m", f"rx_{axis}_m"} <= set(known.index)]
    ends = {axis: (float(known[f"tx_{axis}_m"]), float(known[f"rx_{axis}_m"])) for axis in axes}
    now = float(np.sqrt(sum((tx - rx) ** 2 for tx, rx in ends.values())))
    if not now > 0:
        return {}
    ratio = distance_m / now
    return {f"tx_{axis}_m": rx + (tx - rx) * ratio for axis, (tx, rx) in ends.items()}
