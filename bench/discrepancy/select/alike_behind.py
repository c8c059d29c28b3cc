"""What obstacles of one kind do to all links behind them, beside which some are struck."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import View
from bench.discrepancy.select.settings import FEWEST_SEVERAL
from bench.physics.effect import Effect

Floats = NDArray[np.float64]


def alike_behind(
    kinds: Mapping[str, type[Effect]],
    view: View,
    links: NDArray[np.intp],
    spared: NDArray[np.bool_],
) -> Iterator[Floats]:
    """Yield what every effect of listed obstacles does to `links` [L], one kind of these at a time.

    Those that act on several links, none of which is `spared` [L].
    """
    code = np.searchsorted(links, view.links)
    count = np.bincount(code, minlength=len(links))
    for kind in kinds.values():
        for way in np.hstack(kind.ways(view.scene) or [np.zeros((len(code), 0))]).T:
            each = np.bincount(code, way, len(links)) / count
            if (each != 0).sum() >= FEWEST_SEVERAL and not each[spared].any():
                yield each


def in_common(offset_m: Floats) -> float:
    """Return the middle of the shortest stretch that half of the offsets [L] lie in, in metres."""
    ordered = np.sort(offset_m)
    half = (len(ordered) + 1) // 2
    wide = ordered[half - 1 :] - ordered[: len(ordered) - half + 1]
    first = int(np.argmin(wide))
    return float(ordered[first] + ordered[first + half - 1]) / 2
