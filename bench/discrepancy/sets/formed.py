"""Names against laws of a definite form: a name stays only where no law predicts as well.

A name's columns are free curves, and the laws beside them are too (see `blocks`): neither says
that what is there is a step or a saturation. A law of the grammar is fitted to what the rest of a
set leaves, and takes the place of a name as one more block, its form and free constant paid for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from math import log
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.law.between import over_places, times_of
from bench.discrepancy.law.forms import over_what
from bench.discrepancy.law.likelihood import effective_share
from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.screen import promising
from bench.discrepancy.law.settings import LAW_FEWEST_ROWS, LAW_SAME_PLACE_M
from bench.discrepancy.law.structures import GridLaw, cost
from bench.discrepancy.sets.beside import nats_with, told_from_delays, weighed_with
from bench.discrepancy.sets.blocks import off_by, standard, varies_with
from bench.discrepancy.sets.choice import MERE, Set
from bench.discrepancy.sets.evidence import Columns
from bench.discrepancy.sets.settings import (
    DEFORMED,
    FORM_NATS,
    FORMS_TRIED,
    LAW_M,
    LEAST_WEIGHT,
    NAME_NATS,
    SAME_SHAPE,
    TIED_NATS,
)
from bench.physics.effect import Effect
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import RangeScale

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]
IN_THE_WAY = ("obstacles", "los")


@dataclass(frozen=True)
class Formed:
    """A law with its free constant fitted: `parts` [n, 1] of its shape, what it `pays` in nats.

    `over` are the columns that it is about, "" for devices and most categories (see `_gate`);
    `offset`: whether a constant stands beside it; `times` [n, k]: see `times_of`. Where it is
    multiplied with a number, `by` [n] is that, `factor` its column, and `bare` [n, 1] are the parts
    without it.
    """

    name: str
    parts: tuple[Floats, ...]
    pays: float
    over: frozenset[str]
    offset: bool
    times: Floats
    by: Floats | None = None
    factor: str = ""
    bare: tuple[Floats, ...] = ()


@dataclass(frozen=True)
class Beaten:
    """Names of a set that a law stands in for, with its lead over them in nats."""

    names: Set
    law: Formed
    lead: float


def beaten(contest: Contest, best: Set) -> Beaten | None:
    """Return the names of a set that hold out least against a law; None where all do.

    A law over what a name is about must do better, for the name is such a law, of known physics.
    One over anything else need only do about as well: then nothing here tells them apart.
    """
    found = [held for gone in groups_of(contest, best) if (held := _against(contest, best, gone))]
    return max(found, key=lambda one: one.lead, default=None)


def restored(contest: Contest, causes: Set, whole: Set) -> Set:
    """Return the whole set where names that a deformation did for are missed, else the causes.

    A deformation is a law without a form. Where a law of a definite form then beats what is left,
    and none beats the whole set, those names are that law.
    """
    smaller = set(causes) < set(whole) and set(whole) - set(causes) <= contest.library
    able = smaller and beaten(contest, causes) is not None and beaten(contest, whole) is None
    return whole if able else causes


def groups_of(contest: Contest, best: Set) -> list[Set]:
    """Return the names of a set that a law may stand in for: each, and all of them.

    And what would be a name, were it more than a small constant.
    """
    names = tuple(one for one in best if one in contest.library or one == MERE)
    return [(one,) for one in names] + ([names] if len(names) > 1 else [])


def _against(contest: Contest, best: Set, gone: Set) -> Beaten | None:
    """Return the law that stands in for some names of a set, None where none does."""
    rest = tuple(one for one in best if one not in gone)
    before = max(contest.nats(best), _off(contest, best, gone))
    tried = []
    able = (law for law in formed(contest, best, gone) if not _named_scale(contest, gone, law))
    for law in able:
        held = max(before, _varied(contest, best, gone, law))
        lead = nats_with(contest, rest, {law.name: law.parts}) - law.pays - held
        leads = lead > _least(contest, gone, law)
        wins = leads or (lead > TIED_NATS and _another(contest, best, gone, law))
        if wins and not (_bends if leads else _mostly)(contest, rest, gone, law):
            tried.append(Beaten(gone, law, lead))
    return max(tried, key=lambda one: one.lead, default=None)


def _least(contest: Contest, gone: Set, law: Formed) -> float:
    """Return by how many nats a law must lead some names.

    Behind what these are about it is a form of theirs; over another number, too, it is two causes.
    """
    gates = law.over & {*IN_THE_WAY}
    theirs = frozenset(column for one in gone for column in about(contest.kinds[one]))
    return FORM_NATS + (NAME_NATS if gates & theirs and law.over - theirs else 0.0)


def _off(contest: Contest, best: Set, gone: Set) -> float:
    """Return the log evidence of a set of which some names may be off, as no law must gain by."""
    shifts = contest.shifts(best)
    columns = {o: off_by(shifts[o], contest.rows)[contest.known] for o in gone}
    return _beside_own(contest, best, {f"{o}, off": (some,) for o, some in columns.items()})


def _beside_own(contest: Contest, best: Set, forms: Columns) -> float:
    """Return the log evidence of a set with other forms of its names, of their usual size."""
    more = {one: tuple(map(contest.seen, parts)) for one, parts in forms.items()}
    blocks = {one: contest.evidence.blocks[one] for one in best}
    other = contest.evidence.with_blocks({**blocks, **more})
    other.widest |= dict.fromkeys(more, 1.0)
    return other.of((*best, *more)).nats / contest.crowding


def _varied(contest: Contest, best: Set, gone: Set, law: Formed) -> float:
    """Return the log evidence of a set of which some names vary with what a law is multiplied with.

    By no more than another form of them may: a law must lead by what it is over. A temperature
    hardly changes beside its zero, so that any form times it is another form of what that is.
    """
    may = [o for o in gone if law.factor in varies_with(contest.rows, contest.kinds[o])]
    if law.by is None or not may:
        return -np.inf
    sizes = DEFORMED * standard(law.by).clip(-2, 2)
    shifts = contest.shifts(best)
    more = {f"{o}, varied": ((sizes * shifts[o][contest.known])[:, None],) for o in may}
    return _beside_own(contest, best, more)


def formed(contest: Contest, best: Set, gone: Set) -> list[Formed]:
    """Return the laws that do most for what the rest of a set leaves."""
    names = tuple(one for one in best if one not in gone)
    left = left_by(contest, best, gone)
    frame = contest.rows.frame.iloc[contest.known].reset_index(drop=True)
    every = material(frame, left, contest.rows.links[contest.known])
    part = every.take(np.flatnonzero(contest.evidence.weights > LEAST_WEIGHT))
    told = (
        law
        for law in laws_of(every, part)
        if not over_places(tuple(law.over))
        or told_from_delays(contest, names, law.parts, law.pays + NAME_NATS, law.times)
    )
    return list(islice(told, FORMS_TRIED))


def left_by(contest: Contest, best: Set, gone: Set) -> Floats:
    """Return what a set leaves of the known rows [n], in metres, without what some of it does."""
    made = contest.evidence.of(best)
    rest = [contest.evidence.response(made, one) for one in best if one not in gone]
    return np.asarray(
        contest.evidence.left_m - np.sum([np.zeros(len(contest.known)), *rest], axis=0)
    )


def laws_of(every: Material, part: Material) -> Iterator[Formed]:
    """Yield the laws of some rows, the best first, as blocks over all; none where they are few."""
    if len(part.residual_m) < LAW_FEWEST_ROWS:
        return
    fits = [(law, law.fitted(part)) for law in promising(part, float(len(part.residual_m)))]
    if not fits:
        return
    first = max(fits, key=lambda one: one[1].fit.likelihood - cost(one[0], 2.0))[1].fit
    share = effective_share(part.residual_m - first.shift_m, part.links)
    rows = max(share * len(part.residual_m), 2.0)
    fits.sort(key=lambda one: cost(one[0], rows) - share * one[1].fit.likelihood)
    yield from (_formed(every, law, law.free_value(found), rows) for law, found in fits)


def _formed(every: Material, law: GridLaw, free: float, rows: float) -> Formed:
    """Return a law with its free constant as a block; amplitudes pay by their evidence."""
    parts = _parts(law.design(every, free))
    pays = bool(law.shape.free) * log(rows) / 2 + log(max(law.choices, 1))
    factor = every.factors[law.by]
    over = {column.text for column in [over_what(every, law.at)] if law.at >= 0}
    over |= {_gate(factor.text) if factor.group else factor.text} if law.by else set()
    name = f"{law.form}: {law.expression}"
    found = Formed(name, parts, pays, frozenset(over), law.offset, times_of(every, law, free))
    if not law.by or factor.group:
        return found
    bare = _parts(replace(law, by=0).design(every, free))
    return replace(found, by=factor.weights, factor=factor.text, bare=bare)


def _parts(design: Floats) -> tuple[Floats, ...]:
    """Return the columns of a design [n, k] as parts [n, 1] of the size of laws."""
    size = np.maximum(np.sqrt((design**2).mean(axis=0)), 1e-12)
    return tuple((LAW_M * design / size)[:, [i]] for i in range(design.shape[1]))


def _gate(text: str) -> str:
    """Return the column by which a law is only behind something, "" where it is of other rows."""
    return next((one for one in IN_THE_WAY if text.startswith(f"({one} ")), "")


def _bends(contest: Contest, rest: Set, names: Set, law: Formed) -> bool:
    """Return whether a law is what some names do, and beside it a little that bends it.

    A lag times the speed is a lag, though it vary by a tenth; what bends it may be said beside.
    """
    own = np.array([_within(contest, names, part) for part in law.parts])
    if own.all() or not own.any():
        return False
    factors = weighed_with(contest, rest, {law.name: law.parts}).factors[-len(law.parts) :]
    parts = np.hstack(law.parts) * factors
    mine, more = parts[:, own].sum(axis=1), parts[:, ~own].sum(axis=1)
    return bool((more**2).sum() < DEFORMED**2 * (mine**2).sum())


def _mostly(contest: Contest, rest: Set, names: Set, law: Formed) -> bool:
    """Return whether a law that is no likelier than some names is mostly what these do.

    A lag that grows with a temperature is its mean, and a little that bends it: it tells of no
    other cause. Asked of names of one column; what devices or curves may be is nearly anything.
    """
    columns = contest.evidence.columns[
        :, [p for one in names for p in contest.evidence.places[one]]
    ]
    if columns.shape[1] > 1 or not np.ptp(columns):
        return _bends(contest, rest, names, law)
    factors = weighed_with(contest, rest, {law.name: law.parts}).factors[-len(law.parts) :]
    whole = np.hstack(law.parts) @ factors
    mine = columns @ np.linalg.lstsq(columns, whole, rcond=None)[0]
    return bool(((whole - mine) ** 2).sum() < DEFORMED**2 * (mine**2).sum())


def _named_scale(contest: Contest, gone: Set, law: Formed) -> bool:
    """Return whether a law in the place of an error of the level is a scale, beside a constant.

    That has a name, which is said with the error where it does as well (see `beside_a_constant`):
    what a scale does is no law without a name. Only where antenna delays may be the constant.
    """
    if not all(contest.kinds[one].follows for one in gone):
        return False
    if not {RangeScale.name, AntennaDelay.name} <= contest.library:
        return False
    scale = contest.bare(RangeScale.name)
    ways = np.hstack([scale, np.ones_like(scale[:, :1])])
    return all(_spanned(ways, part) for part in law.parts)


def _another(contest: Contest, best: Set, names: Set, law: Formed) -> bool:
    """Return whether a law is about anything else than some names of a set.

    A law beside a constant is no other cause than a name that does nothing but a constant, nor is
    one that acts only behind what a name is about, however it goes on there. In free space a level
    is a logarithm of the distance.
    """
    kinds = [contest.kinds[one] for one in names]
    columns = frozenset(column for kind in kinds for column in about(kind))
    if _over(contest, best, names, law) <= columns or law.over & columns & {*IN_THE_WAY}:
        return False
    if _within(contest, names, law.parts[0]) or _level(contest, names, law):
        return False
    return not (law.offset and _constant(contest, best, names))


def _level(contest: Contest, names: Set, law: Formed) -> bool:
    """Return whether names follow a level, and a law is how that falls in free space (Friis)."""
    if not all(contest.kinds[one].follows for one in names):
        return False
    distance_m = contest.rows.frame["true_range_m"].to_numpy(np.float64)[contest.known]
    fall = np.log(np.maximum(distance_m, LAW_SAME_PLACE_M))[:, None]
    return all(_spanned(np.hstack([fall, np.ones_like(fall)]), part) for part in law.parts)


def _over(contest: Contest, best: Set, names: Set, law: Formed) -> frozenset[str]:
    """Return what a law is about in the place of some names: what it is the better for.

    Not the number that it is multiplied with, where the law without that does about as well.
    """
    if law.by is None:
        return law.over
    rest = tuple(one for one in best if one not in names)
    whole, bare = (nats_with(contest, rest, {law.name: some}) for some in (law.parts, law.bare))
    return law.over if whole - bare > -TIED_NATS else law.over - {law.factor}


def _constant(contest: Contest, best: Set, names: Set) -> bool:
    """Return whether a mere constant does all that some names of a set do."""
    rest = tuple(one for one in best if one not in names)
    parts = (np.full((len(contest.known), 1), LAW_M),)
    lead = contest.nats(best) - nats_with(contest, rest, {"a constant": parts})
    return bool(lead < FORM_NATS)


def about(kind: type[Effect]) -> frozenset[str]:
    """Return the columns that an effect is about."""
    needs = {column for way in kind.needs for column in way}
    return frozenset(needs | ({kind.follows} if kind.follows else set()))


def _within(contest: Contest, names: Set, part: Floats) -> bool:
    """Return whether some names can do exactly what a part [n, 1] of a law does."""
    places = np.concatenate([contest.evidence.places[one] for one in names])
    return _spanned(contest.evidence.columns[:, places], part)


def _spanned(columns: Floats, part: Floats) -> bool:
    """Return whether columns [n, k] make up a part [n, 1]."""
    left = rest_of(part, columns)
    return float((left**2).sum()) < SAME_SHAPE * float((part**2).sum())
