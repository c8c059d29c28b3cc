"""The causes that act on ranges, weighed as a set in what the named waveform effects leave.

Summed scores name what is loudest; of a tail and a wall delay of 6 cm, the tail. The range is one
observable of twenty, but all that a delay moves. So once waveforms have their names, sets of causes
are compared on ranges alone (see `bench.discrepancy.sets`). What waveform effects do to ranges
depends on how a receiver detects, and library forms do not know how: smooth deformations of their
responses, and small shifts over everything known, take part as what has no name.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.beside_level import beside_level, by_links
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, View, without
from bench.discrepancy.data.covariates import OF_DEVICES
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.select.flattened import Ranged, unsure_by_size
from bench.discrepancy.select.row_weights import row_weights
from bench.discrepancy.select.settings import (
    DETECTION_M,
    DETECTION_SHARE,
    LEVEL_PRINTED_DB,
    UNLISTED_M,
)
from bench.discrepancy.select.state import Round, Search, State
from bench.discrepancy.select.stepwise import locate_left, loses
from bench.discrepancy.sets.blocks import (
    OF_CLOCKS,
    deformed,
    kept_rows,
    named_kinds,
    of_laws,
    of_library,
)
from bench.discrepancy.sets.choice import Choice
from bench.discrepancy.sets.choose import judged_by_sets
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.install import rounds_of, together
from bench.discrepancy.sets.mere_constant import as_mere
from bench.discrepancy.sets.mistaken import mistaken
from bench.discrepancy.sets.set_up import of_setup
from bench.discrepancy.sets.settings import LAW_SIZE
from bench.discrepancy.sets.steadier_levels import over_steadier_levels
from bench.discrepancy.sets.sure import beyond_doubt
from bench.discrepancy.settings import PATHS_ONLY_RICHER, RESIDUAL_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.fitted.pattern_gain import PatternGain
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.specular import in_room
from bench.physics.units import Floats
from bench.physics.ways import known_mostly, spread_over

Turns = tuple[Round, ...]


def with_range_part(state: State, journal: Journal, unlisted: bool = False) -> State:
    """Return the state with the set of causes that ranges speak for beside waveform effects.

    What held-out links lose by is not taken. Where nothing differed, a name must be beyond doubt,
    as of ranges alone: a search looks at means over intervals, and one late device of five, among
    links that scatter, stands out of none. `unlisted`: waveforms show what no effect explains,
    which may shift ranges too.
    """
    search, safely = state.search, state.guard.safely
    if not (search.fit.waveform and state.rounds):
        return state
    rows = search.both
    aside = _of_waves_alone(rows)
    kinds = {n: kind for n, kind in search.kinds.items() if kind.name not in aside}
    ranged = replace(search, work=rows, kinds=kinds)
    ask = safely("ranges", journal.kept(asked), (Choice(), state.added))
    found, beside = ask(ranged, state.added, unlisted)
    if not (state.rounds[0].located.significant or beyond_doubt(found)):
        return state
    if found.mistaken:
        return replace(state, search=replace(search, choice=found))
    if not found.names:
        return _nameless(state, found)
    fit = safely("fitting a set of causes", journal.kept(together), ())
    found, added = _without_mere(ranged, found, fit(replace(ranged, choice=found), beside))
    if not found.names:
        return _nameless(state, found)
    if not added or loses(search, added, state.added):
        return state
    contest = safely("fitting a set of causes", journal.kept(rounds_of), ())
    turns = contest(replace(ranged, choice=found), beside, added, state.rounds[0].located)
    return _installed(state, found, added, turns) if turns else state


def _nameless(state: State, found: Choice) -> State:
    """Return the state with what ranges show where they speak for no name."""
    known = replace(
        state.search.choice, forms_do=found.forms_do, tied=found.tied, others=found.others
    )
    return replace(state, search=replace(state.search, choice=known))


def _without_mere(ranged: Search, found: Choice, added: Added) -> tuple[Choice, Added]:
    """Return a choice and its effects without names that came out as small constants."""
    mine = {effect.physics: effect for effect in added if effect.physics in found.names}
    left = as_mere(found, {name: _moved_m(ranged, added, one) for name, one in mine.items()})
    gone = {mine[name] for name in set(mine) - set(left.names)}
    return left, tuple(effect for effect in added if effect not in gone)


def asked(ranged: Search, added: Added, unlisted: bool) -> tuple[Choice, Added]:
    """Return the set of causes that ranges speak for, and the effects that stay beside it.

    What waveforms named and ranges may name too is weighed again with them. Where they do not, it
    stays as waveforms have it, if it bends levels, and the rest is asked again. What only delays
    all paths is for ranges to say: waveforms begin where a path is seen. A gain over the heading
    stays anyhow: it delays nothing.
    """
    names = judged_by_sets(ranged)
    gains = tuple(effect for effect in added if isinstance(effect, PatternGain))
    beside = tuple(e for e in added if e.physics not in names or e in gains)
    found = chosen_beside(ranged, beside, unlisted)
    silent = tuple(e for e in added if e.physics in names - set(found.names) and e not in gains)
    kept = tuple(effect for effect in silent if _bends_levels(ranged, effect))
    if not kept or found.mistaken:
        return found, beside
    theirs = {effect.physics for effect in kept}
    rest = {name: kind for name, kind in ranged.kinds.items() if kind.name not in theirs}
    beside = tuple(e for e in added if e in beside or e in kept)
    return chosen_beside(replace(ranged, kinds=rest), beside, unlisted), beside


def _moved_m(ranged: Search, added: Added, effect: Effect) -> Floats:
    """Return by how much one of some effects makes ranges longer beside the others, in metres."""
    with_it, without_it = (
        ranged.comparison.ensemble(ranged.both, some, RESIDUAL_MEMBERS)
        for some in (added, without(added, effect))
    )
    if RANGE not in with_it.names:
        return np.zeros(0)
    moved = with_it.simulated_of(RANGE) - without_it.simulated_of(RANGE)
    return np.asarray(moved.mean(axis=0))


def _bends_levels(ranged: Search, effect: Effect) -> bool:
    """Return whether an effect moves levels of any row by more than they are printed to."""
    with_it, without_it = (
        ranged.comparison.ensemble(ranged.both, some, RESIDUAL_MEMBERS) for some in ((effect,), ())
    )
    if LEVEL not in with_it.names:
        return True
    moved_db = (with_it.simulated_of(LEVEL) - without_it.simulated_of(LEVEL)).mean(axis=0)
    return bool(np.nanmax(np.abs(moved_db), initial=0.0) > LEVEL_PRINTED_DB)


def _of_waves_alone(rows: View) -> set[str]:
    """Return the names of causes of which ranges beside waveforms are not asked.

    The step of a diffraction where metal stands is one between groups, which takes part without a
    name. The floor of a known room is one of its reflections, which waveforms show.
    """
    floor = {GroundBounce.name} if in_room(rows.scene).all() else set()
    return {Diffraction.name} | floor


def _installed(state: State, found: Choice, added: Added, turns: Turns) -> State:
    """Return the state with new effects, their rounds before the last, and what is left then."""
    names = set(found.names) | {e.physics for e in state.added} - {e.physics for e in added}
    old = tuple(t for t in state.rounds if not (t.added and t.added.physics in names))
    left = locate_left(state.search, added, len(old) + len(turns))
    last = Round(left, state.rounds[-1].explanation, None)
    old = old[:-1] if old and old[-1].added is None and len(old) > 1 else old
    search = replace(state.search, choice=found)
    return replace(state, search=search, added=added, rounds=(*old, *turns, last))


def chosen_beside(ranged: Search, beside: Added, unlisted: bool = False) -> Choice:
    """Return the set of causes that ranges of all working rows speak for beside some effects.

    And, with `unlisted`, beside whatever a cause that nobody listed may do to a detector.
    """
    rows = ranged.work
    assert rows is not None
    ensemble = ranged.comparison.ensemble(rows, beside, _members(ranged, beside))
    if RANGE not in ensemble.names:
        return Choice()
    left = beside_level(rows, ensemble, ensemble.residual_of(RANGE))
    known = np.flatnonzero(np.isfinite(left))
    forms = receiver_forms(ranged, rows, ensemble, beside, unlisted)[known]
    if unlisted:
        forms = np.hstack([forms, unlisted_forms(rows)[known]])
    level = rows.recorded.column(LEVEL) if LEVEL in rows.recorded.names else left * np.nan
    library = kept_rows(of_library(ranged.kinds, by_links(rows, ensemble)), known)
    laws = kept_rows(of_laws(ranged.kinds, rows) | of_setup(rows), known)
    every = named_kinds(ranged.kinds, rows)
    alone = Evidence(left[known], rows.links[known], library)
    alone.weights = row_weights(left[known], level[known], rows.links[known])
    library |= over_steadier_levels(alone, ranged.kinds, rows, known)
    given = Ranged(
        left[known], alone.weights,
        library | laws, dict.fromkeys(laws, LAW_SIZE), {name: every[name] for name in library},
        ranged.comparison.crowding(rows) ** 2, rows, known,
    )  # fmt: skip
    contest = given.beside(forms)
    best = contest.settled()
    best = replace(best, unsure=unsure_by_size(given, forms, contest, best))
    if forms.size:  # a detector may follow a column too
        likeliest = set(contest.physical(contest.able))
        return replace(best, forms_do=not unlisted and likeliest <= set(best.names))
    causes = (*best.names, *best.others)
    return replace(best, mistaken=mistaken(contest, causes, ranged.doubtful, ensemble))


def _members(ranged: Search, beside: Added) -> int:
    """Return how many versions ranges are held against: of a table as many as without waveforms.

    Nothing is simulated for these where no effect stands beside, and the mean of four similar
    links is off by half of what one is.
    """
    free = isinstance(ranged.comparison, TableComparison) and not beside
    return RESIDUAL_MEMBERS * (PATHS_ONLY_RICHER if free else 1)


def receiver_forms(
    search: Search, rows: View, whole: Ensemble, beside: Added, unlisted: bool
) -> Floats:
    """Return what a receiver of another kind may make of waveform effects [n, k], in metres.

    Smooth deformations of what every effect does to ranges, where it does something, and small
    shifts over what is known: over what changes clocks alone too where `unlisted`, as nobody knows
    what that goes by.
    """
    if all(effect.stage == "ranging" for effect in beside):
        return np.zeros((len(rows.rows), 0))
    but = () if unlisted else OF_CLOCKS  # no detector can follow a clock
    parts = [DETECTION_M * known_columns_of(rows, but)]
    for effect in (one for one in beside if one.stage != "ranging"):
        rest = search.comparison.ensemble(rows, without(beside, effect), RESIDUAL_MEMBERS)
        response = np.nan_to_num((whole.simulated_of(RANGE) - rest.simulated_of(RANGE)).mean(0))
        bent = deformed(response, rows, calibrated=False)
        parts += [bent, DETECTION_SHARE * response[:, None]]
    return np.hstack(parts)


def unlisted_forms(rows: View) -> Floats:
    """Return what a changed waveform may do to every detector alike [n, k], in metres.

    Anything smooth over distance and level, and more or less in every group but devices.
    """
    groups = [m for n, m in rows.covariates.groups.items() if not n.startswith(OF_DEVICES)]
    columns = [np.ones(len(rows.rows)), *(mask.astype(np.float64) for mask in groups)]
    level = rows.recorded.column(LEVEL) if LEVEL in rows.recorded.names else None
    over = (known_mostly(v) for v in (rows.scene.true_range_m, level) if v is not None)
    curves = [spread_over(values) for values in over if values is not None]
    return np.asarray(UNLISTED_M * np.hstack([np.stack(columns, axis=1), *curves]))


def known_columns_of(rows: View, but: tuple[str, ...]) -> Floats:
    """Return one, every number in standard deviations and every group but devices [n, k].

    Without the numbers `but`.
    """
    columns: list[Floats] = [np.ones(len(rows.rows))]
    for value in (v for name, v in rows.covariates.numbers.items() if name not in but):
        filled = np.where(np.isfinite(value), value, np.nanmean(value))
        standard = (filled - filled.mean()) / max(float(filled.std()), 1e-9)
        columns.append(np.asarray(np.clip(standard, -2, 2), np.float64))
    groups = rows.covariates.groups.items()
    columns += [mask.astype(np.float64) for name, mask in groups if not name.startswith(OF_DEVICES)]
    return np.stack(columns, axis=1)
