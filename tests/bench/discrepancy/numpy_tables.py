"""Recorded and simulated tables made with numpy alone: no code shared with what is tested."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from bench.recordings.table import Recordings

Hidden = Callable[[pd.DataFrame, np.random.Generator], np.ndarray]


def rows(
    rng: np.random.Generator, links: int, per_link: int, near: float = 2.0, far: float = 20.0
) -> pd.DataFrame:
    """Return geometry and settings of links x per_link rows, distances log-uniform."""
    link = np.repeat(np.arange(links), per_link)
    distance = np.exp(rng.uniform(np.log(near), np.log(far), links))
    pairs = rng.integers(0, 5, links), 5 + rng.integers(0, 6, links)
    return pd.DataFrame(
        {
            "link": [f"link {i}" for i in link],
            "tx": [f"d{i}" for i in pairs[0][link]],
            "rx": [f"d{i}" for i in pairs[1][link]],
            "environment": np.array(["hall", "office", "cellar"])[rng.integers(0, 3, links)][link],
            "true_range_m": distance[link] + rng.uniform(-0.2, 0.2, len(link)),
            "temperature_c": rng.uniform(5, 40, links)[link],
            "reply_time_s": rng.choice([3e-4, 6e-4, 1.2e-3], len(link)),
        }
    )


def measured(frame: pd.DataFrame, rng: np.random.Generator, hidden: Hidden | None) -> pd.DataFrame:
    """Return the rows with errors and receive levels; `hidden` gives what is left out, [n] m."""
    error = 0.028 * rng.standard_t(8, len(frame))
    if hidden is not None:
        error = error + hidden(frame, rng)
    codes = pd.factorize(frame["link"])[0]
    level = (
        -57.0 - 20 * np.log10(frame["true_range_m"]) + rng.normal(0, 1.2, codes.max() + 1)[codes]
    )
    level = level + rng.normal(0, 0.4, len(frame))
    return frame.assign(error_m=error, range_m=frame["true_range_m"] + error, rx_power_dbm=level)


def tables(
    seed: int,
    hidden: Hidden | None = None,
    *,
    links: int = 60,
    per_link: int = 6,
    replicas: int = 3,
    paired: bool = True,
    theirs: tuple[float, float] = (2.0, 20.0),
) -> tuple[Recordings, Recordings]:
    """Return a recorded table, and one of a simulator that leaves `hidden` out.

    `replicas` simulated rows for each recorded one; not `paired`: other links, distances `theirs`.
    """
    rng = np.random.default_rng(seed)
    ours = rows(rng, links, per_link)
    recorded = measured(ours, rng, hidden)
    others = []
    for number in range(replicas):
        frame = ours if paired else rows(rng, links, per_link, *theirs)
        made = measured(frame, rng, None)
        others.append(made if paired else made.assign(link=f"other {number} " + made["link"]))
    simulated = pd.concat(others, ignore_index=True)
    return Recordings(recorded, "numpy"), Recordings(simulated, "other", simulator="numpy")


def walls(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Nothing but a metre and more in one link of nine: blocked."""
    codes = pd.factorize(frame["link"])[0]
    count = codes.max() + 1
    struck = rng.random(count) < 0.11
    return np.where(struck, 0.4 + rng.exponential(1.0, count), 0.0)[codes]


def warmth(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """3 mm per degree."""
    return 0.003 * (frame["temperature_c"].to_numpy() - 20)


def constant(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """0.12 m everywhere."""
    return np.full(len(frame), 0.12)


def crystals(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Crystals that differ by some ppm."""
    ppm = dict(zip([f"d{i}" for i in range(11)], rng.normal(0, 2.0, 11), strict=True))
    offset = frame["tx"].map(ppm).to_numpy(float) - frame["rx"].map(ppm).to_numpy(float)
    return 0.1498 * offset * frame["reply_time_s"].to_numpy() * 1e3


def scale(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Outside the library: 4 mm per metre."""
    return 0.004 * frame["true_range_m"].to_numpy()


def room_law(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Outside the library: the error swings with the temperature, once every 9 degrees."""
    return 0.1 * np.sin(2 * np.pi * frame["temperature_c"].to_numpy() / 9)
