"""Whether a named effect, simulated at the recorded rows, reproduces what it acts on.

A score says that an effect helps; it does not say that recordings look like it. So before a name is
stated, the named effects are simulated once more (a posterior predictive check: Gelman, Meng and
Stern 1996), and means and spreads of every observable, in all rows, over groups and intervals of
every covariate and as trends, are compared with the recorded ones. What is left where an effect
acts must be small beside its own response there: library forms are never exactly right, so a share
of the response is allowed, chance too. A trend over a covariate that the effect does not depend on
is allowed less.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select.elsewhere import moves_ranges
from bench.discrepancy.select.predictive_cells import (
    Cells,
    fresh_ensemble,
    kept,
    place_weight,
    predictive_places,
    response_cells,
    told_by_places,
    typical_size,
)
from bench.discrepancy.select.settings import LIKE_NONE, OF_LINKS_DB, OF_LINKS_SHARE
from bench.discrepancy.select.within_links import drawn_by_rows, of_links
from bench.discrepancy.settings import (
    ADEQUACY_ALPHA,
    ADEQUACY_BROUGHT,
    ADEQUACY_CUT,
    ADEQUACY_LEFT,
    ADEQUACY_MOST,
    ADEQUACY_OFF_COVARIATE,
    ADEQUACY_TOUCHED,
    LEAST_CRPS,
    ONE_SIDED_95,
)
from bench.physics.effect import Effect

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
LEVELS = ("rx_power_dbm", "energy_db")
MOMENTS = ("the mean", "the spread")
KNOWN_MOMENTS = ("mean", "spread")  # of a located cell, in that order
CHANNEL = (
    "true_range_m", "tx", "rx", "pair", "room", "environment", "los", "obstacle", "obstructed",
    "time_s", "clock_offset_ppm",
)  # fmt: skip
"""How the names of the covariates begin that a channel or a receiver may depend on.

Time among them: places are recorded one after the other; and the offset of two crystals, which
tells the devices.
"""


@dataclass(frozen=True)
class Adequacy:
    """How much of the structure an effect acts on is left with it.

    `left` is what is left over the largest response of the effect in the same observable, `z` the
    same in standard errors, `where` the place and observable in words; `adequate` whether that
    may be chance or another form of the same effect. `note`: another reason why it is not.
    """

    adequate: bool
    left: float = 0.0
    z: float = 0.0
    where: str = ""
    note: str = ""

    def against(self, name: str) -> str:
        """Return in words why an effect may not be named; one that leaves all is no likeness."""
        if self.note:
            return f"looks most like {name}, but {self.note}"
        sure = f"({self.z:.1f} standard errors)"
        if self.left >= LIKE_NONE:
            return (
                f"like none of the known effects: the nearest, {name}, leaves {self.where} off by "
                f"as much as it changes anything there {sure}"
            )
        return f"looks most like {name}, but {self.words}"

    @property
    def words(self) -> str:
        """Why an effect may not be named, of itself."""
        return self.note or (
            f"with it {self.where} still differs, by {self.left:.0%} of the most that it changes "
            f"({self.z:.1f} standard errors)"
        )


def adequacy(
    comparison: Comparison,
    views: tuple[View, ...],
    added: Added,
    effect: Effect,
    wanted: tuple[Cell, ...] = (),
) -> Adequacy:
    """Return whether `added` reproduces, on the rows of `views`, what its `effect` acts on.

    `wanted` are the cells that differed when the effect was brought in.
    """
    whole = fresh_ensemble(comparison, views, added)
    rest = fresh_ensemble(comparison, views, without(added, effect))
    names = tuple(n for n in whole.names if n in rest.names)
    if RANGE in names and not views[0].waveform:  # from paths alone levels are approximate
        names = (RANGE,) if moves_ranges(whole, rest) else names
    if type(effect).stage != "ranging" and views[0].waveform:  # no receiver's detector is another's
        names = tuple(n for n in names if n != RANGE)
    if type(effect).by_rows and views[0].waveform:  # its shape hangs on rays within a pulse
        names = tuple(n for n in names if n in LEVELS)
    if views[0].waveform and len(added) > 1:
        names = by_itself(comparison, views, effect, names)
    if not names:
        return Adequacy(True)
    if type(effect).per_link and views[0].waveform and (words := row_by_row(whole, rest)):
        return Adequacy(False, 1.0, note=words)
    places, weights = zip(*predictive_places(views), strict=True)
    crowding = max(comparison.crowding(view) for view in views)
    if not views[0].waveform and (words := link_by_link(whole, rest)):
        return Adequacy(False, 1.0, note=words)
    parts = kept(whole, names), kept(rest, names)
    around = bool(type(effect).logged_as)  # noise is made by whatever runs there
    found = judged(*parts, places, np.stack(weights, 1), crowding, around)
    if not found.adequate or not views[0].waveform:
        return found
    return brought(*parts, [(cell, place_weight(views, cell.place)) for cell in wanted])


def by_itself(
    comparison: Comparison, views: tuple[View, ...], effect: Effect, names: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the names of what an effect changes where it is alone, and not through another.

    A level control counts fewer symbols of strong signals, whatever made them strong: what is left
    of the count is a matter of its curve, and no objection to what made levels so.
    """
    none, alone = (fresh_ensemble(comparison, views, one) for one in ((), (effect,)))
    able = {*none.names} & {*alone.names}

    def same(name: str) -> bool:
        was, now = none.simulated_of(name), alone.simulated_of(name)
        return np.array_equal(was, now, equal_nan=True)

    return tuple(name for name in names if name not in able or not same(name))


def row_by_row(whole: Ensemble, rest: Ensemble) -> str:
    """Return in words that a level changes from row to row, where `whole` has links change it.

    What draws every link anew leaves the rows of a link alike; fading does not.
    """
    for name in LEVELS:
        if name not in whole.names or name not in rest.names:
            continue
        change = whole.simulated_of(name).mean(axis=0) - rest.simulated_of(name).mean(axis=0)
        if float(np.nanmean(np.abs(change))) < OF_LINKS_DB:
            continue
        share, error = of_links(rest, name)
        if share + ONE_SIDED_95 * error < OF_LINKS_SHARE:
            return f"rows of one link have only {share:.0%} of the change of {name} in common"
    return ""


def link_by_link(whole: Ensemble, rest: Ensemble) -> str:
    """Return in words that links keep a change of level, where `whole` has every row draw its own.

    Fading scatters rows of one place; an obstacle, or a reflection of the ground, does not.
    """
    for name in LEVELS:
        if name not in whole.names or name not in rest.names:
            continue
        change = whole.simulated_of(name) - rest.simulated_of(name)
        small = float(np.nanmean(np.abs(change))) < OF_LINKS_DB
        if small or not drawn_by_rows(change, whole.links):
            continue
        share, error = of_links(rest, name)
        if share - ONE_SIDED_95 * error > OF_LINKS_SHARE:
            return f"rows of one link have {share:.0%} of the change of {name} in common"
    return ""


def brought(whole: Ensemble, rest: Ensemble, wanted: list[tuple[Cell, Floats | None]]) -> Adequacy:
    """Return whether an effect cuts down enough of any cell that it was brought in for."""
    able = [
        (cell, weight)
        for cell, weight in wanted
        if weight is not None and cell.moment in KNOWN_MOMENTS and cell.observable in whole.names
    ]
    if not able:
        return Adequacy(True)
    _, left, before = response_cells(whole, rest, np.stack([weight for _, weight in able], axis=1))
    where = [
        (i, whole.place(cell.observable), KNOWN_MOMENTS.index(cell.moment))
        for i, (cell, _) in enumerate(able)
    ]
    share = [float(left[at] / max(before[at], LEAST_CRPS)) for at in where]
    if min(share) <= ADEQUACY_BROUGHT:
        return Adequacy(True)
    first = able[0][0]
    what = f"{first.observable} {first.place.where()}"
    return Adequacy(False, share[0], note=f"it explains {_part(1 - share[0])} of {what}")


def _part(share: float) -> str:
    """Return a share in words, "nothing" where none is left of it."""
    words = f"{max(share, 0.0):.0%}"
    return "nothing" if words == "0%" else f"only {words}"


def judged(
    whole: Ensemble,
    rest: Ensemble,
    places: tuple[Place, ...],
    weights: Floats,
    crowding: float,
    around: bool = False,
) -> Adequacy:
    """Return the adequacy of an effect that `whole` has and `rest` has not.

    Both are of the same rows and observables; `weights` [n, C] say which rows a place has. It is
    refused where what it leaves is beyond chance and a considerable share of its response in most
    of what it acts on; what it has cut down enough is not held against it: other causes may have
    left the rest. Refused too where a covariate of no channel tells what is left - but of what is
    made `around` the radios - and where it moves what did not differ.
    """
    cells = response_cells(whole, rest, weights)
    cells = cells[0], cells[1] / crowding, cells[2] / crowding
    response, left, before = cells
    own = response.max(axis=0)  # of each observable's mean and spread
    acts = own > ADEQUACY_TOUCHED * own.max(initial=0.0)
    beyond = norm.isf(ADEQUACY_ALPHA / 2 / max(left[:, acts].size, 1))
    seen = (left > beyond) & (left > ADEQUACY_CUT * before) & acts
    told = told_by_places(whole, rest, weights) > beyond
    elsewhere = None if around else _elsewhere(whole.names, places, cells, seen & told)
    return (
        elsewhere
        or _most(whole.names, places, cells, seen, acts)
        or _needless(whole.names, cells, acts)
        or Adequacy(True)
    )


def _elsewhere(
    names: tuple[str, ...], places: tuple[Place, ...], cells: Cells, seen: Mask
) -> Adequacy | None:
    """Return what is left over a covariate that no channel knows, None where that is little.

    Another form of the effect may leave a trend over distance or level, none over a temperature.
    What is `seen` there goes with the covariate by more than links differ anyway.
    """
    response, left, _ = cells
    acts = seen.any(axis=0)
    here = response[:, acts].max(axis=1, initial=0.0)[:, None, None]
    foreign = np.array([not of_channel(place.covariate) for place in places])[:, None, None]
    share = np.where(seen & foreign & (left > here), left / np.maximum(response.max(axis=0), 1), 0)
    if share.max(initial=0.0) <= ADEQUACY_OFF_COVARIATE:
        return None
    return _worst(names, places, share, left)


def _most(
    names: tuple[str, ...], places: tuple[Place, ...], cells: Cells, seen: Mask, acts: Mask
) -> Adequacy | None:
    """Return where most is left, None unless too much is in most of what the effect acts on."""
    response, left, before = (typical_size(each) for each in cells)
    limit = np.maximum(np.array(ADEQUACY_LEFT) * response, ADEQUACY_CUT * before)
    wrong = acts & seen.any(axis=0) & (left > limit)
    if (response[wrong] ** 2).sum() <= ADEQUACY_MOST * (response[acts] ** 2).sum():
        return None
    share = np.where(seen & wrong, cells[1] / np.maximum(cells[0].max(axis=0), 1), 0)
    return _worst(names, places, share, cells[1])


def _needless(names: tuple[str, ...], cells: Cells, acts: Mask) -> Adequacy | None:
    """Return that an effect moves what did not differ, None where it brings things nearer."""
    response, left, before = (typical_size(each) * acts for each in cells)
    after, first = np.linalg.norm(left), np.linalg.norm(before)
    if after <= max(float(first), 1.0):
        return None
    most = np.unravel_index(int(response.argmax()), response.shape)
    where = f"{MOMENTS[most[1]]} of {names[most[0]]}"
    return Adequacy(False, 1.0, float(after), where, f"it moves {where}, which did not differ")


def _worst(
    names: tuple[str, ...], places: tuple[Place, ...], share: Floats, left: Floats
) -> Adequacy:
    """Return the refusal that names where most is left."""
    worst = np.unravel_index(int(share.argmax()), share.shape)
    where = f"{MOMENTS[worst[2]]} of {names[worst[1]]} {places[worst[0]].where()}"
    return Adequacy(False, float(share[worst]), float(left[worst]), where)


def of_channel(covariate: str | None) -> bool:
    """Return whether what happens on the way or in a receiver may depend on a covariate.

    Where the devices stand, what stands between them, and which they are.
    """
    return covariate is None or covariate.startswith(CHANNEL)
