"""Where MILUV's antennas were: from motion-capture poses, lever arms and anchor constellations.

Lever arms and constellations as the publisher's development kit lists them
(github.com/decargroup/miluv, config/uwb), in metres; coordinates to 0.1 mm.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]
AGREES_M = 0.005
LEVER_ARMS_M = {
    10: (0.13189, -0.17245, -0.05249),
    11: (-0.17542, 0.15712, -0.05307),
    20: (0.16544, -0.15085, -0.03456),
    21: (-0.15467, 0.16972, -0.01680),
    30: (0.16685, -0.18113, -0.05576),
    31: (-0.13485, 0.15468, -0.05164),
}
CONSTELLATIONS_M = {
    "0": (
        (3.2738, 3.4640, 1.8093), (3.1864, 0.2739, 1.5885), (2.8505, -2.9231, 1.8974),
        (-2.4976, -3.5018, 1.7731), (-2.9579, 0.6128, 1.6571), (-2.7347, 3.6585, 1.8903),
    ),
    "0b": (
        (3.3439, 3.4166, 1.8022), (3.1969, 0.2316, 1.5844), (2.7928, -2.9472, 1.8933),
        (-2.5565, -3.4260, 1.7760), (-2.9277, 0.6933, 1.6492), (-2.6656, 3.7154, 1.8925),
    ),
    "1": (
        (2.9598, 3.2037, 1.4155), (3.0090, 0.2435, 1.4191), (2.6760, -2.7577, 1.4206),
        (-2.5070, -3.4934, 1.4279), (-2.9881, -0.1359, 1.4286), (-2.8022, 3.5683, 1.4225),
    ),
    "2": (
        (3.2816, 0.8334, 1.2503), (3.0746, -0.4014, 1.9076), (-3.1432, -2.7218, 1.3383),
        (-2.3323, -3.3928, 1.8457), (-1.7947, 4.1983, 1.8233), (-0.2947, 4.1459, 1.2260),
    ),
    "2b": (
        (3.2685, 0.8692, 1.2521), (3.0872, -0.3669, 1.9042), (-2.2817, -3.4448, 1.8313),
        (-3.1043, -2.7832, 1.3248), (-1.8516, 4.1563, 1.8310), (-0.3505, 4.1318, 1.2367),
    ),
}  # fmt: skip


def positions(rows: pd.DataFrame, at_initiator: NDArray[np.bool_]) -> dict[str, Any]:
    """Return `tx_x_m` .. `rx_z_m` [n], NaN where they are not known; nothing without poses.

    `rx` is the initiator where `at_initiator` [n], the responder elsewhere.
    """
    if "r_iw_a_ifo001" not in rows:
        return {}
    first, second = _best_fit(rows)
    rx = np.where(at_initiator[:, None], first, second)
    tx = np.where(at_initiator[:, None], second, first)
    return {
        f"{end}_{axis}_m": places[:, number]
        for end, places in (("tx", tx), ("rx", rx))
        for number, axis in enumerate("xyz")
    }


def _best_fit(rows: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return both ends [n, 3] with the constellation that gives the true ranges."""
    true_m = rows["gt_range"].to_numpy(np.float64)
    ends = np.full((2, len(rows), 3), np.nan)
    for anchors in CONSTELLATIONS_M.values():
        tried = [_places(rows, rows[end].to_numpy(), anchors) for end in ("from_id", "to_id")]
        off = np.abs(np.linalg.norm(tried[0] - tried[1], axis=1) - true_m)
        fits = (off < AGREES_M)[:, None]
        ends = np.where(fits & np.isnan(ends), np.stack(tried), ends)
    return ends[0], ends[1]


def _places(rows: pd.DataFrame, devices: NDArray[Any], anchors: Any) -> Floats:
    """Return where each row's device was [n, 3]; NaN for one that is neither anchor nor tag."""
    places = np.full((len(rows), 3), np.nan)
    for device in np.unique(devices):
        mask = devices == device
        if device < len(anchors):
            places[mask] = anchors[int(device)]
        elif device in LEVER_ARMS_M:
            places[mask] = _tag(rows[mask], int(device))
    return places


def _tag(rows: pd.DataFrame, tag: int) -> Floats:
    """Return the tag's antenna [n, 3]: the robot's position plus its turned lever arm."""
    from scipy.spatial.transform import Rotation

    robot = f"ifo{tag // 10:03d}"
    if f"q_ai_{robot}" not in rows:
        return np.full((len(rows), 3), np.nan)
    centre, attitude = _vectors(rows[f"r_iw_a_{robot}"], 3), _vectors(rows[f"q_ai_{robot}"], 4)
    return centre + Rotation.from_quat(attitude).apply(LEVER_ARMS_M[tag])


def _vectors(column: pd.Series, size: int) -> Floats:
    """Return the numbers of cells such as `[ 0.1 -2.0 3 ]` as [n, size]."""
    cells = [str(cell).strip("[] ").split() for cell in column]
    whole = [cell if len(cell) == size else ["nan"] * size for cell in cells]
    return np.array(whole, dtype=np.float64).reshape(-1, size)
