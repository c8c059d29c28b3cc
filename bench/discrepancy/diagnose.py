"""A whole diagnosis of two tables: split, search, open the confirm links, model what is left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.resimulation import Added, Resimulation, View, World, hidden, view
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.table import TableWorld
from bench.discrepancy.data.checks import check_recorded
from bench.discrepancy.data.observables import Window, window_of
from bench.discrepancy.data.split import LinkSplit, Rows, link_codes, split_links
from bench.discrepancy.fit.residual_curve import unnamed_effect
from bench.discrepancy.select.candidates import library
from bench.discrepancy.select.stepwise import Diagnosis, Search, diagnose
from bench.discrepancy.select.verdict import Unknown
from bench.physics.effect import Effect
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

CONFIRM_MEMBERS = 16
CONFIRM_FIRST = 5000
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Options:
    """How much is done: rows used for search, fit and confirmation, the seed, what is compared.

    `waveform` False simulates from paths alone (see `View`).
    """

    seed: int = 0
    search_rows: int = 2000
    fit_rows: int = 500
    confirm_rows: int = 2000
    hide: tuple[str, ...] = ()
    observables: tuple[str, ...] | None = None
    waveform: bool = True


@dataclass(frozen=True)
class Confirmed:
    """Before and after on links that nothing was tuned on.

    `gain` in nats (see `gain.py`); `mae_before_m`, `mae_after_m`: mean |recorded error - ensemble
    mean| in metres; `auc_before`, `auc_after`: how well a classifier tells recorded from simulated
    rows (0.5 = not at all); `ranks_before`, `ranks_after`: deviation of ensemble ranks from
    uniform (Kolmogorov distance, 0 = calibrated). `before` and `after` are the ensembles.
    """

    links: int
    rows: int
    gain: Estimate
    mae_before_m: Estimate
    mae_after_m: Estimate
    auc_before: float
    auc_after: float
    ranks_before: float
    ranks_after: float
    before: Ensemble
    after: Ensemble
    view: View


@dataclass(frozen=True)
class Study:
    """A finished diagnosis; `simulator` has the effects added, None where a table was compared."""

    source: str
    simulated: str
    diagnosis: Diagnosis
    added: Added
    confirmed: Confirmed
    split: LinkSplit
    simulator: Simulator | None
    mix: dict[str, tuple[float, float]] = field(default_factory=dict)
    options: Options = field(default_factory=Options)


def study(
    recorded: Recordings,
    simulated: Simulator | Recordings,
    options: Options | None = None,
    tell: Tell = lambda _: None,
    kinds: dict[str, type[Effect]] | None = None,
    journal: Journal | None = None,
) -> Study:
    """Diagnose `recorded` against a simulator or a table. Raises BenchError on bad input.

    `kinds` restricts the library. Deterministic from `options.seed`. What a `journal` keeps of an
    earlier, unfinished diagnosis of the same input is not done again.
    """
    asked = options or Options()
    check_recorded(recorded)
    frame = hidden(recorded.frame, asked.hide)
    split = split_links(frame, asked.seed)
    window = window_of(frame)
    world = _world(simulated, window, asked.seed)
    codes = link_codes(frame)

    def look(rows: Rows, most: int) -> View:
        kept = thinned(rows, codes, most)
        return view(frame, codes, kept, window, asked.observables, asked.waveform)

    library_, skipped = library()
    discover, fit = look(split.discover, asked.search_rows), look(split.fit, asked.fit_rows)
    work = None if asked.waveform else look(split.work, asked.search_rows)
    kept = journal or Journal()
    kept.know(kinds or library_)
    search = Search(world, discover, fit, kinds or library_, asked.seed, tell, work, kept)
    found = diagnose(search)
    found = Diagnosis(found.verdicts, found.added, found.rounds, {**skipped, **found.skipped})
    rest = tuple(v for v in found.verdicts if isinstance(v, Unknown))
    extra = unnamed_effect(world, fit, found.added, rest[0].findings) if rest else None
    extra = extra if extra and _helps(world, discover, found.added, extra, asked.seed) else None
    added = (*found.added, extra) if extra else found.added
    tell("confirming on links that nothing was tuned on")
    confirmed = confirm(world, look(split.confirm.open(), asked.confirm_rows), added, asked.seed)
    after = world.with_effects(added) if isinstance(world, Resimulation) else None
    mix = world.mix(discover) if isinstance(world, TableWorld) else {}
    name = simulated.label if isinstance(simulated, Recordings) else simulated.name
    return Study(recorded.label, name, found, added, confirmed, split, after, mix, asked)


def _world(simulated: Simulator | Recordings, window: Window, seed: int) -> World:
    """Return the counterpart of the recorded rows."""
    if isinstance(simulated, Recordings):
        return TableWorld(simulated.frame, window, seed)
    return Resimulation(simulated, window)


def _helps(world: World, held: View, added: Added, extra: Effect, seed: int) -> bool:
    """Return whether an unnamed discrepancy improves the score of links it was not fitted on."""
    ensembles = [
        world.ensemble(held, effects, CONFIRM_MEMBERS, CONFIRM_FIRST - CONFIRM_MEMBERS)
        for effects in (added, (*added, extra))
    ]
    return gain_interval(tally(ensembles[0]), tally(ensembles[1]), seed).above_zero


def thinned(rows: Rows, links: NDArray[np.intp], most: int) -> Rows:
    """Return at most about `most` rows, evenly from every link."""
    if len(rows) <= most:
        return rows
    place = pd.Series(links[rows])
    order = place.groupby(place).cumcount().to_numpy()
    size = place.map(place.value_counts()).to_numpy()
    quota = np.maximum(1, most // len(np.unique(links[rows])))
    wide = np.maximum(size, quota)
    keep = (order * quota) // wide != ((order - 1) * quota) // wide
    return np.asarray(rows[keep])


def confirm(world: World, held: View, added: Added, seed: int) -> Confirmed:
    """Compare before and after on held-out rows."""
    before = world.ensemble(held, (), CONFIRM_MEMBERS, CONFIRM_FIRST)
    after = world.ensemble(held, added, CONFIRM_MEMBERS, CONFIRM_FIRST) if added else before
    return Confirmed(
        links=len(np.unique(held.links)),
        rows=len(held.rows),
        gain=gain_interval(tally(before), tally(after), seed),
        mae_before_m=_mae(before, seed),
        mae_after_m=_mae(after, seed),
        auc_before=separability(before, seed),
        auc_after=separability(after, seed),
        ranks_before=rank_distance(before),
        ranks_after=rank_distance(after),
        before=before,
        after=after,
        view=held,
    )


def _mae(ensemble: Ensemble, seed: int) -> Estimate:
    """Return the mean |recorded range error - ensemble mean| in metres."""
    if "error_m" not in ensemble.names:
        return Estimate(np.nan, np.nan, np.nan, "m")
    left = np.abs(ensemble.residual[:, ensemble.names.index("error_m")])
    return cluster_bootstrap(left, ensemble.links, seed, "m")


def separability(ensemble: Ensemble, seed: int) -> float:
    """Return the AUC of a classifier telling recorded from simulated rows, held out by link."""
    from sklearn.ensemble import HistGradientBoostingClassifier
    from sklearn.metrics import roc_auc_score
    from sklearn.model_selection import GroupKFold, cross_val_predict

    links = len(np.unique(ensemble.links))
    if links < 2:
        return float("nan")
    X = np.concatenate([ensemble.recorded, ensemble.simulated[0]])
    y = np.repeat([1, 0], len(ensemble.links))
    groups = np.tile(ensemble.links, 2)
    model = HistGradientBoostingClassifier(max_iter=40, max_leaf_nodes=8, random_state=seed)
    guess = cross_val_predict(
        model, X, y, groups=groups, cv=GroupKFold(min(4, links)), method="predict_proba"
    )
    return float(roc_auc_score(y, guess[:, 1]))


def rank_distance(ensemble: Ensemble) -> float:
    """Return the Kolmogorov distance of the range's ensemble ranks from uniform."""
    name = "error_m" if "error_m" in ensemble.names else ensemble.names[0]
    ranks = ensemble.ranks()[:, ensemble.names.index(name)]
    ordered = np.sort(ranks[np.isfinite(ranks)])
    if not len(ordered):
        return float("nan")
    return float(np.abs(ordered - (np.arange(len(ordered)) + 0.5) / len(ordered)).max())
