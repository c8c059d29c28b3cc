"""What rows of one link have in common, and how far they lie from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.select.settings import FEWEST_SEVERAL, ONE_STEP, SEVERAL_ROWS
from bench.discrepancy.settings import (
    LEAST_SCATTER_M,
    MAD_TO_STD,
    RARE_BEYOND,
    RARE_FEWEST,
    RESOLUTION,
    ROW_OFF_STD,
    SHORTEST_DETOUR_M,
    STRUCK_LEVEL_LINKS,
)
from bench.physics.effect import Effect
from bench.physics.effects.ranging.range_rounding import RangeRounding

Floats = NDArray[np.float64]


def link_medians(values: Floats, code: NDArray[np.intp]) -> Floats:
    """Return the median over the known rows of each link, [v, L], of values [v, n]; else NaN."""
    return np.asarray(pd.DataFrame(values.T).groupby(code).median().to_numpy(np.float64).T)


def within(made: Ensemble, once: NDArray[np.bool_] | None = None) -> tuple[Floats, Floats]:
    """Return how far recorded [n] and simulated ranges [m, n] lie from their link, in metres.

    As far as a row lies from a mean it has no part in; NaN for links of one row. `once` [m, n] are
    the simulated rows that count (see `own_draws.once`), NaN for others.
    """
    code = np.unique(made.links, return_inverse=True)[1]
    values = made.versions_of(RANGE)
    known = np.ones(values.shape, bool)
    if once is not None:
        known[1:] = once
    pairs = zip(values, known, strict=True)
    left = np.stack([_beside_mean(one, code, some) for one, some in pairs])
    return left[0], left[1:]


def _beside_mean(values: Floats, code: NDArray[np.intp], known: NDArray[np.bool_]) -> Floats:
    """Return how far known values [n] lie from the mean of the others of their link."""
    count = np.bincount(code, known)[code]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.bincount(code, np.where(known, values, 0.0))[code] / count
        whole = np.where(known & (count > 1), np.sqrt(count / (count - 1)), np.nan)
        return np.asarray((values - mean) * whole)


def rows_off(ensemble: Ensemble, step_m: float = 0.0) -> float:
    """Return the share of the rows that lie off their own link by as much as a detour does.

    A blocked path stays blocked: all rows of a link are struck alike. Where devices move its detour
    changes, so a row is off a link that is itself off only by half of that. Of links of three rows.
    Beyond the share of simulated rows: what is rounded to a coarse step `step_m` jumps by one, and
    how often hangs on where between two points a link lies.
    """
    code = np.unique(ensemble.links, return_inverse=True)[1]
    left = ensemble.versions_of(RANGE) - ensemble.simulated_of(RANGE).mean(axis=0)
    recorded, *simulated = (_share_off(one, code, step_m) for one in left)
    return max(recorded - float(np.mean(simulated)), 0.0) if simulated else recorded


def coarsest_m(added: Added) -> float:
    """Return the coarsest step that effects round ranges to, in metres; 0 where none does."""
    grids = (one for one in added if isinstance(one, RangeRounding))
    return max((step for one in grids for step in (one.step_m, *one.steps_m)), default=0.0)


def _share_off(left: Floats, code: NDArray[np.intp], step_m: float) -> float:
    """Return the same of one version, of what is left of its rows [n] in metres."""
    several = (np.bincount(code) > 2)[code]
    own = link_medians(left[None], code)[0][code]
    off, changes = np.abs(left - own)[several], np.abs(own)[several] / 2
    if not len(off):
        return 0.0
    within = MAD_TO_STD * float(np.nanmedian(off))
    least = max(ROW_OFF_STD * within, SHORTEST_DETOUR_M / 2, ONE_STEP * step_m)
    return float(np.mean(off > np.maximum(changes, least)))


def rows_beyond(ensemble: Ensemble) -> int:
    """Return how many rows lie farther off than any simulated row, by far; 0 with one version.

    Recorded and simulated rows are each beside the mean of the simulated ones (the others).
    """
    simulated = ensemble.simulated_of(RANGE)
    m = len(simulated)
    if m < RARE_FEWEST:
        return 0
    middle = simulated.mean(axis=0)
    widest = float(np.nanmax(np.abs(simulated - middle))) * m / (m - 1)
    off = np.abs(ensemble.residual_of(RANGE))
    return int(np.sum(off > RARE_BEYOND * max(widest, LEAST_SCATTER_M)))


def weakened(bare: Ensemble, outlying: NDArray[np.bool_]) -> float:
    """Return the evidence, in nats, that outlying links [L] are weaker than all others.

    What blocks a path takes its level; what else puts a link far off need not. One loss in common,
    which pays for itself (Schwarz 1978); 0 without levels.
    """
    if LEVEL not in bare.names or outlying.sum() < STRUCK_LEVEL_LINKS or outlying.all():
        return 0.0
    code = np.unique(bare.links, return_inverse=True)[1]
    level_db = link_medians(bare.residual_of(LEVEL)[None], code)[0]
    if not np.isfinite(level_db).all():
        return 0.0
    middle = float(np.median(level_db[~outlying]))
    wide = MAD_TO_STD * float(np.median(np.abs(level_db[~outlying] - middle)))
    error = max(wide, RESOLUTION["dB"]) * np.sqrt(1 / outlying.sum() + 1 / (~outlying).sum())
    z = min(float(level_db[outlying].mean() - middle) / error, 0.0)
    return float(max(z**2 / 2 - np.log(len(level_db)) / 2, 0.0))


def as_loud(effect: Effect, bare: Ensemble, parts: NDArray[np.intp]) -> Effect:
    """Return an effect that strikes links with what arrives there as loud as recorded.

    `bare` is beside the simulator without it; `parts` [L] are 0 for spared links, 1 for struck
    ones. As it is where levels of either are not known. Medians over links: a few may be both.
    """
    name = type(effect).struck_level
    if not name or LEVEL not in bare.names:
        return effect
    code = np.unique(bare.links, return_inverse=True)[1]
    level_db = link_medians(bare.residual_of(LEVEL)[None], code)[0]
    sides = [level_db[(parts == part) & np.isfinite(level_db)] for part in (0, 1)]
    if not all(map(len, sides)):
        return effect
    louder_db = float(np.median(sides[1]) - np.median(sides[0]))
    item = next(p for p in type(effect).parameters() if p.name == name)
    return replace(effect, **{name: float(np.clip(louder_db, item.low, item.high))})


def of_links(ensemble: Ensemble, name: str) -> tuple[float, float]:
    """Return which share of a mismatch rows of one link have in common, and its standard error.

    Of the variance of an observable beyond the simulated one: between links over all (the
    intraclass correlation: Fisher 1925). (nan, nan) where too few links have several rows.
    """
    code = np.unique(ensemble.links, return_inverse=True)[1]
    values = ensemble.versions_of(name) - np.nanmean(ensemble.simulated_of(name), axis=0)
    several = (np.bincount(code)[code] > 1) & np.isfinite(values).all(axis=0)
    links = len(np.unique(code[several]))
    if links < FEWEST_SEVERAL:
        return float("nan"), float("nan")
    parts = np.array([components(each[several], code[several]) for each in values])
    between, within = parts[0] - parts[1:].mean(axis=0)
    share = max(between, 0.0) / max(max(between, 0.0) + max(within, 0.0), 1e-12)
    return float(share), float((1 - share**2) / np.sqrt(links - 1.5))


def drawn_by_rows(change: Floats, links: NDArray[np.intp]) -> bool:
    """Return whether what an effect changes [m, n] is drawn for every row, not for every link."""
    code = np.unique(links, return_inverse=True)[1]
    several = np.bincount(code)[code] > 1
    if not several.any() or not np.isfinite(change).all():
        return False
    parts = np.array([components(one[several], code[several]) for one in change])
    between, within = np.maximum(parts.mean(axis=0), 0.0)
    return bool(within > between)


def components(values: Floats, code: NDArray[np.intp]) -> tuple[float, float]:
    """Return the variance between links and within them, of values [n] of links with 2 rows.

    `code` [n] tells the links.
    """
    place, count = np.unique(code, return_inverse=True)[1], np.unique(code, return_counts=True)[1]
    mean = np.bincount(place, values) / count
    within = float(((values - mean[place]) ** 2).sum() / (len(values) - len(count)))
    return float(np.var(mean)) - within * float(np.mean(1 / count)), within


def rows_per_link(values: Floats, code: NDArray[np.intp]) -> float:
    """Return as how many independent values those [n] of a link count in the mean, 1 at least.

    By what rows of a link, told by `code` [n], have in common (the design effect: Kish 1965).
    """
    links = len(np.unique(code))
    rows = len(values) / max(links, 1)
    if links < FEWEST_SEVERAL or rows < SEVERAL_ROWS:
        return 1.0
    between, within = components(values, code)
    alike = max(between, 0.0) / max(max(between, 0.0) + within, 1e-300)
    return float(rows / (1 + (rows - 1) * alike))
