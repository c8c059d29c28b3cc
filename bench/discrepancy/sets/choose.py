"""The set of causes that ranges speak for, and which names could stand in it for others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.beside_level import by_links
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.residual_range import crowded, residual_range
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.beside import (
    elsewhere,
    leading_faults,
    misplaced,
    told_law,
)
from bench.discrepancy.sets.blocks import (
    OF_RANGE,
    Blocks,
    kept_rows,
    named_kinds,
    of_laws,
    of_library,
    of_one_device,
    usual_levels,
)
from bench.discrepancy.sets.calibrated import without_calibration
from bench.discrepancy.sets.choice import Choice, Set, but, but_not, shifting
from bench.discrepancy.sets.constant_in import constant_in_all
from bench.discrepancy.sets.crystals import as_delay_and_drift
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.faded import faded, fading_db
from bench.discrepancy.sets.formed import beaten, restored
from bench.discrepancy.sets.mere_constant import without_mere_constants
from bench.discrepancy.sets.mistaken import beside_alike, mistaken
from bench.discrepancy.sets.nearly_straight import as_scale
from bench.discrepancy.sets.own_detours import beyond_detours
from bench.discrepancy.sets.own_form import allowed, beyond_others, others_may, told_by_form
from bench.discrepancy.sets.own_scale import scales_for_delays, without_scales
from bench.discrepancy.sets.own_weights import likeliest
from bench.discrepancy.sets.possible import best_possible
from bench.discrepancy.sets.rivals import beside_a_constant, clear_levels, delays_and_more, rivals
from bench.discrepancy.sets.set_up import of_setup
from bench.discrepancy.sets.settings import (
    BEAM,
    EXPLAINED_STRAYS,
    FEWEST_ROWS,
    LAW_NATS,
    LAW_SIZE,
    MOST_CAUSES,
    MOST_LAWS,
    NAME_NATS,
    RANGE_LAW_NATS,
    RIVAL_NATS,
)
from bench.discrepancy.sets.spared import moves_every_row
from bench.discrepancy.sets.steadier_levels import over_steadier_levels
from bench.discrepancy.sets.steady import same_in_every_link
from bench.discrepancy.sets.told_levels import told_by_levels
from bench.discrepancy.sets.unsure import unsure
from bench.discrepancy.sets.weigh import weighed
from bench.discrepancy.settings import RESIDUAL_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.ranging.antenna_delay import AntennaDelay

Floats = NDArray[np.float64]


def judged_by_sets(search: Search) -> frozenset[str]:
    """Return the names that sets decide about: none where other things than ranges are compared."""
    if search.work is None or len(search.work.rows) < FEWEST_ROWS:
        return frozenset()
    if RANGE not in search.work.recorded.names:
        return frozenset()
    return frozenset(named_kinds(search.kinds, search.work))


def chosen(search: Search, beside: Added) -> Choice:
    """Return the set of causes that ranges of all rows speak for, `beside` those in place."""
    made = _contest(search, beside)
    if made is None:
        return Choice()
    contest, ensemble = made
    found = replace(contest.settled(), beside=shifting(beside))
    best, alike = (*found.names, *found.others), beside_alike(search, beside, contest)
    return replace(found, mistaken=mistaken(alike, best, search.doubtful, ensemble))


def worth_beside(search: Search, beside: Added) -> float:
    """Return the log evidence of the best set beside some effects, its names paid for."""
    return made[0].worth(made[0].calm()) if (made := _contest(search, beside)) else -np.inf


def _contest(search: Search, beside: Added) -> tuple[Contest, Ensemble] | None:
    """Return the contest of all causes on the working rows, None without ranges there."""
    rows = search.work
    made = rows and residual_range(search.comparison, rows, beside, RESIDUAL_MEMBERS)
    if rows is None or not made:
        return None
    ensemble, left = made
    known = np.flatnonzero(np.isfinite(left))
    library = kept_rows(of_library(search.kinds, by_links(rows, ensemble)), known)
    laws = kept_rows(of_laws(search.kinds, rows) | of_setup(rows), known)
    widest = dict.fromkeys(laws, LAW_SIZE)
    evidence = Evidence(left[known], rows.links[known], library | laws, widest)
    evidence.scatter_m2 = ensemble.scatter_of(RANGE) ** 2
    evidence.links_m2 = ensemble.links_scatter_of(RANGE, rows.scene.true_range_m) ** 2
    evidence.lie_behind(~rows.scene.clear()[known])
    evidence = evidence.with_blocks(
        evidence.blocks | over_steadier_levels(evidence, search.kinds, rows, known)
    )
    kinds = {n: kind for n, kind in named_kinds(search.kinds, rows).items() if n in library}
    usual, crowding = usual_levels(rows, ensemble)[known], crowded(search.comparison, rows)
    contest = Contest(evidence, kinds, crowding, rows, known, usual)
    drawn_m, contest.fading = ensemble.simulated_of(RANGE)[0], fading_db(rows, ensemble)[known]
    contest.drawn_m, contest.told = np.nan_to_num(drawn_m[known]), told_by_levels(rows, ensemble)
    return contest, ensemble


def decided(search: Search, beside: Added) -> bool:
    """Return whether the choice of a search is of its rows and these effects beside it."""
    choice, rows = search.choice, search.work
    return rows is not None and (choice.view, choice.beside) == (rows.number, shifting(beside))


class Contest:
    """Sets of causes beside each other; those of `kinds` have a name, the others are laws.

    `crowding`: as how many one counts of rows that share their simulated rows. `rows` are those of
    the evidence, `known` which it has; `usual`: see `usual_levels`. `pays`: nats, by form.
    `told`: see `told_by_levels`. `able` are the causes that took part to the end.
    """

    def __init__(
        self,
        evidence: Evidence,
        kinds: Mapping[str, type[Effect]],
        crowding: float,
        rows: View,
        known: NDArray[np.intp],
        usual: NDArray[np.bool_],
    ) -> None:
        self.kinds, self.crowding = kinds, crowding
        self.rows, self.known, self.usual = rows, known, usual
        self.library = frozenset(n for n, kind in kinds.items() if kind.tellable(rows.scene))
        self.untold = frozenset(kinds) - self.library
        self.pays, self.told = dict[str, float](), dict[str, float]()
        self.single = of_one_device(evidence.blocks)
        every = [block for blocks in self.single.values() for block in blocks.items()]
        self.evidence = evidence.with_blocks(evidence.blocks | dict(every))
        self._nats: dict[Set, float] = {}
        self.able: Set = ()
        self.weights = np.ones(len(known))  # of rows, in the evidence
        self.fading = self.drawn_m = np.zeros(len(known))  # see `fading_db`; a simulated version

    def settled(self) -> Choice:
        """Return the set that wins; a name that a deformation of the others can do for goes."""
        whole = self.calm()
        first = self._at_usual_levels(self._beyond_deformed(whole))
        placed = misplaced(self, first)
        behind = self.nats(placed) - self.nats(first)
        tied = but_not(first, placed) if behind < RIVAL_NATS else ()
        held = self._beyond_forms(restored(self, placed, whole))
        held = constant_in_all(self, same_in_every_link(self, as_scale(self, held)))
        best = without_calibration(self, without_scales(self, moves_every_row(self, held)))
        best = as_delay_and_drift(self, without_mere_constants(self, best))
        names = tuple(one for one in best if one in self.library)
        beside = {one: beside_a_constant(self, best, one) for one in names}
        able = {one: rivals(self, best, one) for one in names}
        if scale := scales_for_delays(self, best):
            able[AntennaDelay.name] = tuple(sorted({*able[AntennaDelay.name], *scale}))
        delays = delays_and_more(self, best, able.get(AntennaDelay.name, ()))
        return Choice(
            names,
            tuple(one for one in best if one not in self.library),
            {one: self.brings(best, one) for one in names},
            {o: tuple(sorted({*able[o], *beside[o]})) for o in names},
            {one: unsure(self, best, one) for one in names},
            self.shifts(best),
            constants_m={o: m for some in (delays, *beside.values()) for o, m in some.items()},
            tied=tied if set(but_not(placed, first)) <= set(best) else (),
            elsewhere=elsewhere(self, best),
            faults=leading_faults(self, best),
        )

    def calm(self) -> Set:
        """Return the best set with weights of its own, without links far off that none explains."""
        first = self._best_able()
        if self._weigh(first) > EXPLAINED_STRAYS * self._weigh(()):
            first = ()
        for _ in range(2):
            first = self._best_at(first)
        other = likeliest(self, first)
        return first if other == first else self._best_at(other)

    def _best_at(self, causes: Set) -> Set:
        self._weigh(causes)
        return self._best_able()

    def _best_able(self) -> Set:
        self.able = self._taking_part()
        return self.physical(self.able)

    def _weigh(self, causes: Set) -> int:
        self._nats = {}
        return self.evidence.reweigh(causes)

    def _taking_part(self) -> Set:
        """Return every name, and the laws that do most."""
        none = {one for part in self.single.values() for one in part} | self.library | self.untold
        names = self.best(tuple(self.library))
        laws = [o for o in self.evidence.blocks if o not in none and told_law(self, o, names)]
        self.weigh([*((law,) for law in laws), *((*names, law) for law in laws)])
        alone = sorted(laws, key=lambda law: -self.nats((law,)))[:MOST_LAWS]
        beside = sorted(laws, key=lambda law: -self.nats((*names, law)))[:MOST_LAWS]
        return tuple(dict.fromkeys((*sorted(self.library), *alone, *beside)))

    def physical(self, able: Set) -> Set:
        """Return the best set of which every name does only what physics allows."""
        return best_possible(self, able)

    def possible(self, causes: Set, name: str) -> bool:
        """Return whether physics allows what a name does to the ranges, or its own form is told."""
        return allowed(self, causes, name) or told_by_form(self, causes, name)

    def have(self, blocks: Blocks) -> None:
        """Take other blocks: sets are weighed anew."""
        self.evidence, self._nats = self.evidence.with_blocks(blocks), {}

    def shifts(self, causes: Set) -> dict[str, Floats]:
        """Return what every cause of a set does to the range of every row [n], in metres."""
        made = self.evidence.of(causes)
        factors = {one: self.evidence.factors(made, one) for one in causes}
        return {one: self.spread(self.bare(one) @ factors[one]) for one in causes}

    def bare(self, cause: str) -> Floats:
        """Return what a cause may do to the ranges of known rows [n, k], in metres."""
        return np.asarray(self.evidence.columns[:, self.evidence.places[cause]])

    def spread(self, values: Floats) -> Floats:
        """Return values of the rows that are known as values of all rows [n], 0 elsewhere."""
        out = np.zeros(len(self.rows.rows))
        out[self.known] = values
        return out

    def seen(self, columns: Floats) -> Floats:
        """Return what the evidence has of columns [n, k] of known rows: here all."""
        return columns

    def nats(self, causes: Set) -> float:
        """Return the log evidence of a set; of devices all may be off, or one alone."""
        key = tuple(sorted(causes))
        if key not in self._nats:
            self.weigh([key])
        return self._nats[key]

    def weigh(self, sets: Iterable[Set]) -> None:
        """Work out `nats` of sets that will be asked for: at once they take less time."""
        asked = dict.fromkeys(tuple(sorted(one)) for one in sets)
        keys = [key for key in asked if key not in self._nats]
        made = weighed(self.evidence, self.single, keys)
        self._nats |= {key: nats / self.crowding for key, nats in made.items()}

    def worth(self, causes: Set) -> float:
        """Return the log evidence of a set less what its names must bring."""
        return self.nats(causes) - sum(map(self.price, causes))

    def weighed(self) -> list[Set]:
        """Return all sets that were weighed, the best first."""
        return sorted(self._nats, key=lambda one: -self.worth(one))

    def price(self, one: str) -> float:
        """Return the nats that a cause must bring."""
        if one in self.library | self.untold:
            return NAME_NATS - self.told.get(one, 0.0)
        if one in self.pays:
            return NAME_NATS + self.pays[one]
        return RANGE_LAW_NATS if one == OF_RANGE else LAW_NATS

    def brings(self, causes: Set, one: str) -> float:
        """Return the evidence that one cause brings beside the others of a set."""
        return self.nats(causes) - self.nats(but(causes, one))

    def best(self, able: Set) -> Set:
        """Return the set of most worth: all pairs, then the best few sets of each size."""
        seen: list[Set] = [()]
        beam: list[Set] = [()]
        for size in range(MOST_CAUSES):
            grown = {
                tuple(sorted((*one, more))) for one in beam for more in able if more not in one
            }
            if not grown:
                break
            self.weigh(grown)
            # a constant and a scale may each do little alone: all pairs are tried
            beam = sorted(grown, key=lambda one: -self.worth(one))[: BEAM if size else None]
            if size and self.worth(beam[0]) < max(map(self.worth, seen)) - NAME_NATS:
                break
            seen += beam
        return max(seen, key=self.worth)

    def _beyond_deformed(self, causes: Set) -> Set:
        """Return the set without names that a smooth deformation of the others does as well as.

        Causes have other forms than the library's, and what these leave must not be a name - but
        where others would have to do what physics forbids.
        """
        while len(names := [one for one in causes if one in self.library]) and len(causes) > 1:
            loudest = max(causes, key=lambda one: self.brings(causes, one))
            gains = {one: beyond_others(self, causes, one) for one in names if one != loudest}
            weak = [o for o in gains if gains[o] < NAME_NATS and others_may(self, causes, o)]
            least = min(weak, key=lambda one: gains[one], default=None)
            if least is None:
                break
            causes = but(causes, least)
        return causes

    def _at_usual_levels(self, causes: Set) -> Set:
        """Return the set without an error of the level that is seen at unusual levels alone.

        Where something stands in the way signals are weaker for their distance, and longer: what
        stands there may be a cause with a name, so the best set without the error is sought anew.
        """
        made = self.evidence.among(clear_levels(self))
        for one in [c for c in causes if c in self.kinds and self.kinds[c].follows]:
            lead = made.of(causes).nats - made.of(but(causes, one)).nats
            if lead < NAME_NATS * self.crowding:
                self.able = but(self.able, one)
                causes = self._beyond_deformed(self.physical(self.able))
        return causes

    def _beyond_forms(self, causes: Set) -> Set:
        """Return the set without names that laws of a definite form, or detours, do as well as."""
        while (held := beaten(self, causes) or faded(self, causes)) is not None:
            law = held.law
            self.evidence = self.evidence.with_blocks({**self.evidence.blocks, law.name: law.parts})
            self.evidence.widest[law.name] = LAW_SIZE
            self.pays[law.name] = law.pays
            self.library -= set(held.names)
            able = dict.fromkeys((*sorted(self.library), *causes, law.name))
            self.able = tuple(one for one in able if one not in held.names)
            causes = self.physical(self.able)
            causes = self._at_usual_levels(self._beyond_deformed(causes))
        return beyond_detours(self, causes)
