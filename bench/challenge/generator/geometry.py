"""Links with devices, obstacles and settings; nothing measured yet."""

from __future__ import annotations

import numpy as np
import pandas as pd

LINKS, ROWS = 120, 8
DEVICES = 7
THICK_M = {"concrete": 0.18, "brick": 0.13, "plasterboard": 0.1, "wood": 0.05}
RARE = (0.05, 0.08)  # share of the links in which a rare cause is present: 3 to 10 % of the rows


def geometry(seed: int, rare: str | None = None) -> pd.DataFrame:
    """Return the links of a case, `LINKS` x `ROWS` rows.

    `rare` names an effect whose cause is to be present in few rows only (concealment `sparse`):
    few walls, few warm rows, one device in few links, few rows inside the antenna's lobe.
    The column `_rare` marks them for the generator and is dropped before a table is shown.
    """
    rng = np.random.default_rng([seed, 1])
    link = np.repeat(np.arange(LINKS), ROWS)
    walled = rng.uniform(size=LINKS) < 0.4
    kinds = rng.choice(sorted(THICK_M), LINKS)
    devices = np.array([rng.permutation(DEVICES)[:2] for _ in range(LINKS)])
    distance = rng.uniform(2, 25, LINKS)
    few = np.zeros(LINKS, bool)
    few[rng.choice(LINKS, round(LINKS * rng.uniform(*RARE)), replace=False)] = True
    warm = rng.uniform(5, 45, LINKS)
    heading = rng.uniform(-180, 180, len(link))
    if rare == "material-delay":
        walled = few
    if rare in ("clock-offset", "antenna-delay"):
        devices = np.array([rng.permutation(DEVICES - 1)[:2] for _ in range(LINKS)])
        devices[few, rng.integers(2, size=int(few.sum()))] = DEVICES - 1
    if rare == "temperature-drift":
        warm = np.where(few, 25 + rng.choice([-20, 20], LINKS), 25.0)
    if rare == "power-bias":
        distance = np.where(few, rng.uniform(1.5, 3, LINKS), rng.uniform(7.5, 9, LINKS))
    if rare == "antenna-pattern":
        heading = np.where(few[link], rng.uniform(-40, 40, len(link)), heading / 2 + 180)
        heading = (heading + 180) % 360 - 180
    return pd.DataFrame(
        {
            "link": [f"link {i}" for i in link],
            "true_range_m": distance[link],
            "tx": [f"device {devices[i][0]}" for i in link],
            "rx": [f"device {devices[i][1]}" for i in link],
            "obstacles": [[str(kinds[i])] if walled[i] else [] for i in link],
            "obstacle_thickness_m": [[THICK_M[str(kinds[i])]] if walled[i] else [] for i in link],
            "los": ~walled[link],
            "time_s": np.sort(rng.uniform(0, 7200, (LINKS, ROWS)), axis=1).ravel(),
            "reply_time_s": rng.uniform(2e-4, 1.2e-3, len(link)),
            "temperature_c": warm[link] + rng.normal(0, 0.3, len(link)),
            "azimuth_deg": heading,
            "supply_v": rng.uniform(2.8, 3.6, LINKS)[link] + rng.normal(0, 0.02, len(link)),
            "_rare": few[link],
        }
    )
