"""Which set of effects waveforms speak for.

Every effect is tried at many points; the likeliest few are fitted, alone and then as pairs and
triples, all members of a set at once. A member is named only if the set without it is less likely
although forms of the others may differ, and if something without a form would not do as well in
its place. Where much is left, or links are farther from the set than its simulated ones, no name
is sure: what nobody listed looks a little like what is.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.joint.agreement import brings_its_own
from bench.discrepancy.joint.apart import beside_a_gain, brought_alone, logged, refuted, unlogged
from bench.discrepancy.joint.beneath import beneath
from bench.discrepancy.joint.chance import by_chance
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.curve import beside_own_curve
from bench.discrepancy.joint.form import beyond_forms, of_form, scatters_more
from bench.discrepancy.joint.grain import Grain
from bench.discrepancy.joint.growth import begun, larger
from bench.discrepancy.joint.nested import Nested
from bench.discrepancy.joint.plainer import flat_gain
from bench.discrepancy.joint.polish import Fit, fitted, key_of, polished
from bench.discrepancy.joint.quiet import Quiet
from bench.discrepancy.joint.remains import coloured, remains
from bench.discrepancy.joint.screen import Screen
from bench.discrepancy.joint.settings import (
    BEAM,
    CLASS_NATS,
    CLASS_SHARE,
    MOST,
    NAME_NATS,
    NAME_SHARE,
    POLISHED,
    REFITTED,
    SETTLED,
    STEPS,
)
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.tone_or_noise import counterparts, steady, told_apart, with_tone
from bench.discrepancy.joint.unformed import beside_unformed
from bench.discrepancy.joint.weighing import Weighing
from bench.errors import BenchError
from bench.forked import in_forks
from bench.physics.effect import Effect
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.pulse_ringing import PulseRinging


class Sets:
    """Sets of effects beside each other; all hold those of `start`, whose marks were seen.

    `tries`: forms of the marked effects. `struck`: some links were struck, of which these may hold
    a few more. Raises BenchError where nothing can be simulated.
    """

    def __init__(
        self,
        comparison: Comparison,
        rows: View,
        few: View,
        kinds: Iterable[type[Effect]],
        tries: Sequence[Added] = ((),),
        struck: bool = False,
    ) -> None:
        self.struck = struck
        self.given, marked = begun(Statistics(comparison, rows), tries)
        bare = fitted(self.given, ())
        if bare is None:
            raise BenchError("nothing can be simulated at these rows")
        self.none = bare
        self.start = marked or bare
        have = set(self.start.names)
        able = [kind for kind in kinds if kind.name not in have]
        some = Statistics(comparison, few).knowing(self.start.effects)
        self.screen = Screen(some, able, self.start.effects)
        self.fits: dict[frozenset[str], Fit] = {frozenset(self.start.names): self.start}
        self.quiet, self.grain = Quiet(self.given), Grain(self.given)
        self.nested = Nested(self.given, self.fits, self._fit)
        self.idle: set[str] = set()
        self.weighing = Weighing(self.given, self.quiet)
        self._refitted: set[Added] = set()

    def chosen(self) -> WaveChoice:
        """Return what the sets say."""
        self._grow()
        best, rivals = self._settled()
        best = self.weighing.plain(best)
        explained = self.weighing.worth(best) - self.weighing.worth(self.none)
        left, much = self._left(best, explained)
        brings = {one: self._brings(best, one) for one in best.names}
        wider = tuple(n for n in best.names if scatters_more(best, self._without(best, n)))
        doubted = best.names if much else self._doubted(best)
        beyond = {one: beyond_forms(self.given, best, one) for one in best.names}
        shown = tuple(name for name in best.names if self._shown(best, name))
        return WaveChoice(
            best.effects, rivals, brings, explained, left, much, self.start.names, wider, doubted,
            beyond, shown,
        )  # fmt: skip

    def _left(self, best: Fit, explained: float) -> tuple[float, bool]:
        """Return what something without a form brings beside a set, and if much (`remains`)."""
        bare = remains(self.given, best, self.none, self.start, explained)
        made = coloured(self.given, best, self.fits, self.weighing.evidence) if bare.much else None
        found = remains(self.given, made, self.none, self.start, explained) if made else bare
        return found.nats, found.much

    def _shown(self, fit: Fit, name: str) -> bool:
        """Return whether a log of its own shows a member, or samples of noise alone a tone.

        These are a measurement of it: no scatter does that, nor is it in doubt how small it is.
        """
        if name == NarrowbandInterference.name and self.quiet.nats(fit.effects) >= NAME_NATS:
            return True
        return self._logged(fit, name)

    def _logged(self, fit: Fit, name: str) -> bool:
        """Return whether a member is what receivers log of it, or of what may do the same.

        Then there is no doubt that one of the two is there.
        """
        rest = self._without(fit, name)
        keys = {one.name: key_of((*rest.effects, one)) for one in self._counterparts(fit, name)}
        alike = {name: fit} | {one: self.fits[key] for one, key in keys.items() if key in self.fits}
        plain = self.weighing.plain(rest)
        return any(logged(self.given, made, plain, one) for one, made in alike.items())

    def _doubted(self, best: Fit) -> tuple[str, ...]:
        """Return the members that bring too little beside something without a form.

        Or that scatter late samples otherwise. None of what is logged as such.
        """
        whole = beside_unformed(self.given, best)
        less = {name: self.weighing.plain(self._without(best, name)) for name in best.names}
        less = {n: rest for n, rest in less.items() if not self._logged(best, n)}
        rests = {name: beside_unformed(self.given, one, best) for name, one in less.items()}
        few = {name for name, rest in rests.items() if whole - rest < NAME_NATS}
        rough = {n for n in less if self.grain.refutes(best.effects, n)}
        return tuple(name for name in less if name in few | rough)

    def _settled(self) -> tuple[Fit, dict[str, Added]]:
        """Return the likeliest set of needed members, and what would do as well as each.

        Where another turns out likelier in the place of one, it begins again with that; so it does
        where the same set is fitted better meanwhile, beside which others may do as well no more.
        """
        begin = self.nested.likeliest(self._likeliest)
        for _ in range(SETTLED):
            best = self._without_idle(self._needed(begin))
            free = [one for one in best.names if one not in self.start.names]
            rivals = {one: self._rivals(best, one) for one in free}
            alike = [fit for fit in self._able() if len(fit.names) == len(best.names)]
            begin = self._likeliest([*alike, *self.nested.wider(best)])
            gained = self.weighing.evidence(begin) - self.weighing.evidence(best)
            if key_of(begin.effects) == key_of(best.effects) and gained < CLASS_NATS:
                break
        return best, rivals

    def _without_idle(self, best: Fit) -> Fit:
        """Return the likelier of a set and of what is needed of the likeliest without idle members.

        These took the place of what has something to do of its own.
        """
        if not self.idle:
            return best
        return self._likeliest((best, self._needed(self._likeliest(self._able()))))

    def _able(self) -> list[Fit]:
        """Return the sets of all that was marked, with none that does nothing of its own."""
        marked, idle = key_of(self.start.effects), self.idle
        return [fit for key, fit in self.fits.items() if marked <= key and not idle & key]

    def _likeliest(self, fits: Iterable[Fit]) -> Fit:
        """Return the set of most evidence; of those that do as well, the one that fits best.

        Where all forms may differ, what does quite another thing may come out as well. A name costs
        what it must bring: two may do together what one does.
        """
        self.weighing.weigh(some := list(fits))
        priced = {id(fit): self.weighing.evidence(fit) - NAME_NATS * len(fit.names) for fit in some}
        first = max(some, key=lambda fit: priced[id(fit)])
        most = priced[id(first)]
        gap = max(CLASS_NATS, (1 - CLASS_SHARE) * (most - self.weighing.evidence(self.none)))
        near = (f for f in some if priced[id(f)] >= most - gap and not self._told(first, f))
        return max(near, key=lambda fit: fit.nats)

    def _grow(self) -> None:
        """Fit the likeliest sets of one, two, three ... effects more."""
        first = self.screen.begun(POLISHED)
        self._fit([(*self.start.effects, effect) for effect in first])
        beam = [fit for fit in self.fits.values() if fit is not self.start]
        for width in BEAM[: MOST - 1]:
            known = max(fit.nats for fit in self.fits.values())
            followed = sorted(beam, key=lambda fit: -fit.nats)[:width]
            beam = self._fit(larger(followed, self.fits, self.screen))
            if not beam or max(fit.nats for fit in beam) < known + NAME_NATS:
                break
        self._fit_ringing()

    def _fit_ringing(self) -> None:
        """Fit the likeliest set with a ringing beneath its tail (`beneath`), if it has one."""
        if PulseRinging.name not in self.screen.points:
            return
        most = max(self.fits.values(), key=lambda fit: fit.nats)
        rung = beneath(self.grain, most.effects)
        self._fit([rung] if rung else [])

    def _fit(self, sets: Iterable[Added], steps: int = STEPS) -> list[Fit]:
        made = [fit for fit in in_forks(lambda one: polished(self.given, one, steps), sets) if fit]
        for fit in made:
            known = self.fits.get(key_of(fit.effects))
            if known is None or fit.nats > known.nats:
                self.fits[key_of(fit.effects)] = fit
        return made

    def _needed(self, fit: Fit) -> Fit:
        """Return a set without members that do not bring enough, least first."""
        while len(fit.names) > len(self.start.names):
            self._refit(fit, fit.names)
            for name in fit.names:
                fit = self.nested.on(self._without(fit, name), fit)
            self.weighing.weigh_plain([fit, *(self._without(fit, name) for name in fit.names)])
            whole = self.weighing.worth(fit) - self.weighing.worth(self._exact)
            brings = {n: self._brings(fit, n) for n in fit.names if n not in self.start.names}
            spare = {n: nats - self._asked(fit, n, whole) for n, nats in brings.items()}
            if min(spare.values()) >= 0:
                spare = {n: nats - self._by_chance(fit, n) for n, nats in spare.items()}
            least = min(spare, key=lambda name: (spare[name], brings[name]))
            if spare[least] >= 0:
                break
            rest = self._without(fit, least)
            if not self._own(fit, rest):
                self.idle.add(least)
            fit = rest
        return fit

    @property
    def _exact(self) -> Fit:
        """The set of what was marked, where marks tell the forms of it; else the empty one."""
        kinds = [type(effect) for effect in self.start.effects]
        return self.none if any(one.own_curve or one.own_form for one in kinds) else self.start

    def _asked(self, fit: Fit, name: str, whole: float) -> float:
        """Return what a member must bring to a set that brings `whole`, in nats.

        A share of that, as other forms of the others may be mistaken for it, and more than there
        is where these would do all of it; but where the others do nothing, no form of them is. And
        it must be seen there, if it would be plain to see.
        """
        rest = self._without(fit, name)
        alone = brought_alone(self.given, fit, rest, name)
        brings = self._brings(fit, name)
        if refuted(self.given, fit, name, alone, brings) or unlogged(self.given, fit, rest, name):
            return float("inf")
        if beside_own_curve(self.given, fit, rest, name) < NAME_NATS:
            return float("inf")
        if not self._own(fit, rest):
            return float("inf")
        formed = of_form(self.given, fit, name)
        if not formed and NAME_SHARE * whole <= NAME_NATS:
            return NAME_NATS
        if alone >= NAME_NATS or beside_a_gain(self.given, fit, rest, name):
            return NAME_NATS
        if self.grain.steadies(fit.effects, rest.effects):
            return NAME_NATS
        return float("inf") if formed else NAME_SHARE * whole

    def _own(self, fit: Fit, rest: Fit) -> bool:
        """Return whether a set does more than its rest and a level, and links agree on that."""
        if flat_gain(self.given, fit, rest, self.weighing.evidence):
            return False
        return brings_its_own(
            self.given, self.weighing.plain(fit), self.weighing.plain(rest), self.struck
        )

    def _by_chance(self, fit: Fit, name: str) -> float:
        """Return what a member may bring on simulated links that lack nothing, in nats."""
        plain = self.weighing.plain
        return by_chance(self.given, plain(fit), plain(self._without(fit, name)))

    def _brings(self, fit: Fit, name: str) -> float:
        """Return the evidence that one member brings beside the others, in nats."""
        return self.weighing.worth(fit) - self.weighing.worth(self._without(fit, name))

    def _without(self, fit: Fit, name: str) -> Fit:
        """Return a set without a member, the rest fitted again."""
        self._refit(fit, (name,))
        rest = tuple(effect for effect in fit.effects if effect.name != name)
        return (self.fits.get(key_of(rest)) or self.start) if rest else self.none

    def _refit(self, fit: Fit, names: Iterable[str]) -> None:
        """Fit a set without each of some members again, beside one another and each once."""
        rests = [tuple(e for e in fit.effects if e.name != name) for name in names]
        new = [rest for rest in rests if rest and rest not in self._refitted]
        self._fit(new, REFITTED)
        self._refitted.update(new)

    def _rivals(self, fit: Fit, name: str) -> Added:
        """Return the effects that would do as well in the place of a member, likeliest first."""
        rest = self._without(fit, name)
        others = [one.effect for one in self.screen.beside(rest.effects) if one.effect.name != name]
        made = self._fit([(*rest.effects, other) for other in others[:2]])
        whole = self.weighing.evidence(fit)
        brought = whole - self.weighing.evidence(rest)
        least = whole - max(CLASS_NATS, self.grain.slack(fit.effects, name) * brought)
        near = [one for one in made if self.weighing.evidence(one) > least]
        same = [one for each in (fit, *near) for one in self._same(each, rest, name, least)]
        able = [one for one in (*near, *same) if not self._told(fit, one)]
        able = [one for one in able if not flat_gain(self.given, one, rest, self.weighing.evidence)]
        best = {one.names[-1]: one.effects[-1] for one in sorted(able, key=self.weighing.evidence)}
        return tuple(best[one] for one in reversed(best) if one != name)

    def _told(self, fit: Fit, other: Fit) -> bool:
        """Return whether samples of noise alone tell two sets apart, and the first is likelier.

        No form of a noise floor makes these alike within a record, as a tone does.
        """
        if self.weighing.evidence(fit) - self.weighing.evidence(other) < CLASS_NATS:
            return False
        said = self.quiet.nats(fit.effects) - self._quiet_of(other, fit)
        if not steady(self.given, other):
            said = max(said, steady(self.given, fit))
        return said >= CLASS_NATS

    def _quiet_of(self, fit: Fit, other: Fit) -> float:
        """Return what quiet samples say of a set that may have a tone for the other's noise floor.

        Where they do not speak for it, were it as loud as that: a weaker one leaves noise over.
        """
        nats = self.quiet.nats(fit.effects)
        toned = {NarrowbandInterference.name} & set(fit.names) - set(other.names)
        return min(nats, self.quiet.nats(with_tone(other.effects))) if toned and nats <= 0 else nats

    def _same(self, fit: Fit, rest: Fit, name: str, least: float) -> list[Fit]:
        """Return sets with what may do the same as one that does well, where that is not told."""
        member = name if name in fit.names else fit.names[-1]
        able = [one for one in self._counterparts(fit, member) if one.name not in rest.names]
        made = self._fit([(*rest.effects, one) for one in able])
        untold = bool(made) and (
            told_apart(self.given, fit, member) < CLASS_NATS or self.quiet.carries(member)
        )
        return [one for one in made if untold or self.weighing.evidence(one) > least]

    def _counterparts(self, fit: Fit, name: str) -> Added:
        """Return what may do the same as a member, of the effects that can be tried."""
        effect = next(one for one in fit.effects if one.name == name)
        return tuple(one for one in counterparts(effect) if one.name in self.screen.points)
