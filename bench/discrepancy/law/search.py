"""The search: every structure fitted on working links, ranked by what it gains and costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import t as student

from bench.discrepancy.law.between import told_from_delays
from bench.discrepancy.law.ceiling import ceilings
from bench.discrepancy.law.curve import best_curve
from bench.discrepancy.law.delay import as_delay, is_delay_of
from bench.discrepancy.law.faults import faults, of_a_rate
from bench.discrepancy.law.floor import floors
from bench.discrepancy.law.forms import over_what
from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.law.likelihood import effective_share, fixed, unmoved
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.plan import PLAN, plans
from bench.discrepancy.law.rounding import roundings
from bench.discrepancy.law.screen import promising
from bench.discrepancy.law.settings import (
    LAW_ACTS_M,
    LAW_DRAWS,
    LAW_FEWEST_ROWS,
    LAW_NATS,
    LAW_TIED_NATS,
)
from bench.discrepancy.law.structures import Fitted, GridLaw, Structure, cost
from bench.discrepancy.settings import INTERVAL_LEVEL

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Candidate:
    """A fitted structure with its lead over no law in nats, complexity paid."""

    structure: Structure
    fitted: Fitted
    nats: float

    @property
    def kind(self) -> tuple[str, tuple[str, ...], str]:
        """What it says apart from figures and a constant beside it."""
        return self.structure.form, self.structure.columns, self.structure.where


@dataclass(frozen=True)
class Proposal:
    """What working links say: the best law, its constants with intervals, and those not excluded.

    `given` is what it was found in, `share` how much a row of it counts (links keep offsets).
    """

    given: Material

    best: Candidate
    constants: tuple[LawConstant, ...]
    tied: tuple[Candidate, ...]
    share: float

    @property
    def scale_m(self) -> float:
        """The scatter of what the best law leaves."""
        return self.best.fitted.fit.scale_m


@dataclass(frozen=True)
class Ranking:
    """Fitted structures, best first, the lead of the best free curve, and how much a row counts."""

    candidates: tuple[Candidate, ...]
    curve_nats: float
    share: float


def propose(given: Material, seed: int) -> Proposal | None:
    """Return the law that working links speak for.

    None where none is worth its complexity, or a free curve does much better than all.
    """
    made = ranking(given)
    ranked = made.candidates
    if not ranked or ranked[0].nats < max(LAW_NATS, made.curve_nats - LAW_NATS):
        return None
    best = _preferred(made, given)
    tied = [one for one in ranked if one is not best and best.nats - one.nats < LAW_TIED_NATS]
    constants = intervals(given, best, seed)
    return Proposal(given, best, constants, _distinct(best, tied), made.share)


def ranking(given: Material) -> Ranking:
    """Return every structure worth fitting, best first.

    How far rows of a link say the same is judged by what the best law leaves.
    """
    if len(given.residual_m) < LAW_FEWEST_ROWS:
        return Ranking((), 0.0, 1.0)
    laws: list[Structure] = [
        *(as_delay(given, law) for law in promising(given, float(len(given.residual_m)))),
        *faults(given), *plans(given), *floors(given), *ceilings(given),
        *roundings(given),
    ]  # fmt: skip
    fits = [(law, law.fitted(given)) for law in laws]
    none = unmoved(given.residual_m).likelihood
    first = max(fits, key=lambda pair: pair[1].fit.likelihood - cost(pair[0], 2.0))
    share = effective_share(given.residual_m - first[1].fit.shift_m, given.links)
    rows = share * len(given.residual_m)
    made = [
        Candidate(law, one, share * (one.fit.likelihood - none) - cost(law, rows))
        for law, one in fits
    ]
    curve, values = best_curve(given)
    lead = share * (curve - none) - values / 2 * np.log(max(rows, 2.0))
    made = [one for one in made if one.nats < LAW_NATS or _told(given, one, share, rows)]
    made.sort(key=lambda one: -one.nats)
    return Ranking(tuple(made), float(lead), share)


def _told(given: Material, one: Candidate, share: float, rows: float) -> bool:
    """Return whether a law, if it is about places, is worth its complexity beside own delays."""
    gain = share * told_from_delays(given, one.structure, one.fitted)
    return gain - cost(one.structure, rows) > LAW_NATS


def _preferred(made: Ranking, given: Material) -> Candidate:
    """Return the best; a fault of the set-up that does about as well goes first.

    One device that stands elsewhere is as good as a law of the bearing for its rows alone; and what
    is in proportion to the true range there is a unit, which a power of nearly one only bends. A
    delay of that device of no less evidence goes before it: one number where a place is three.
    """
    ranked, best = made.candidates, made.candidates[0]
    near = (one for one in ranked if best.nats - one.nats < LAW_TIED_NATS)
    listed = next((o for o in near if o.structure.fault and o.structure.fault != PLAN), None)
    rates = (one for one in ranked if _unbent(one, best) and _tied(made, given, one))
    return _late(ranked, listed) or listed or next(rates, best)


def _late(ranked: Sequence[Candidate], listed: Candidate | None) -> Candidate | None:
    """Return the delay of a device whose place has no more evidence, None without one."""
    if listed is None or listed.structure.fault != "position":
        return None
    ahead = (one for one in ranked if one.nats >= listed.nats)
    return next((o for o in ahead if is_delay_of(o.structure, listed.structure.where)), None)


def _unbent(one: Candidate, best: Candidate) -> bool:
    """Return whether a law is a rate of ranges where the best is another law of the distance."""
    structure, other = one.structure, best.structure
    same = (structure.columns, structure.where) == (other.columns, other.where)
    return same and of_a_rate(structure, [value for _, value, _ in one.fitted.constants])


def _tied(made: Ranking, given: Material, one: Candidate) -> bool:
    """Return whether a rate does about as well as the best on the rows that both act on.

    These have a scatter of their own: another unit has multiplied it, too.
    """
    best = made.candidates[0]
    mine = np.asarray(one.fitted.fit.shift_m) != 0
    left = given.residual_m[mine]
    lead, own = (
        made.share * fixed(law.fitted.fit.shift_m[mine], left).likelihood
        - cost(law.structure, made.share * len(left))
        for law in (best, one)
    )
    return lead - own < LAW_TIED_NATS


def _distinct(best: Candidate, tied: list[Candidate]) -> tuple[Candidate, ...]:
    """Return candidates that say another thing than the best and each other."""
    kinds = {best.kind: best}
    for one in tied:
        kinds.setdefault(one.kind, one)
    return tuple(one for one in kinds.values() if one is not best)


def intervals(given: Material, best: Candidate, seed: int) -> tuple[LawConstant, ...]:
    """Return the constants with 90 % intervals from links drawn again.

    Few links drawn again scatter less than other links would: by the degrees of freedom of those in
    which the law acts, and by Student's t (Imbens and Kolesar 2016).
    """
    drawn = _drawn(given, best.structure, seed)
    wider, out = _wider(given, best), []
    for name, value, unit in best.fitted.constants:
        found = np.array([draw[name] for draw in drawn])
        if name == "phase":  # goes round: beside its value
            found = value + np.angle(np.exp(1j * (found - value)))
        tails = (50 - 50 * INTERVAL_LEVEL, 50 + 50 * INTERVAL_LEVEL)
        ends = value + wider * (np.percentile(found, tails) - value)
        low, high = _to_rows(given, best.structure, name, *ends)
        out.append(LawConstant(name, value, min(float(low), value), max(float(high), value), unit))
    return tuple(out)


def _wider(given: Material, best: Candidate) -> float:
    """Return how many times as wide intervals are as those of links drawn again."""
    shift_m = best.structure.shift_m(given, best.fitted.constants)
    links = len(np.unique(given.links[np.abs(np.nan_to_num(shift_m)) > LAW_ACTS_M]))
    free = max(links - best.structure.free, 2)
    level = 0.5 + INTERVAL_LEVEL / 2
    return float(np.sqrt(max(links, free) / free) * student.ppf(level, free) / ndtri(level))


def _to_rows(
    given: Material, structure: Structure, name: str, low: float, high: float
) -> tuple[float, float]:
    """Return an interval, of a place of a step as far as the next rows where the law acts.

    Between two of these no row tells one place from another.
    """
    if not (isinstance(structure, GridLaw) and structure.form == "step"):
        return low, high
    if name != structure.shape.free:
        return low, high
    values = over_what(given, structure.at).values
    acts = values[(given.factors[structure.by].weights != 0) & np.isfinite(values)]
    below, above = acts[acts <= low], acts[acts >= high]
    return max(below, default=low), min(above, default=high)


def _drawn(given: Material, structure: Structure, seed: int) -> list[dict[str, float]]:
    """Return the constants of the structure fitted to links drawn again."""
    rng = np.random.default_rng(seed)
    rows = [np.flatnonzero(given.links == link) for link in np.unique(given.links)]
    out = []
    for _ in range(LAW_DRAWS):
        picked = rng.integers(0, len(rows), len(rows))
        again = given.take(np.concatenate([rows[i] for i in picked]))
        out.append({name: value for name, value, _ in structure.fitted(again).constants})
    return out
