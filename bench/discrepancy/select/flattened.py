"""Sets of causes on ranges beside what a receiver may make of waveforms that differ.

What it makes is `forms` with normal factors: they take part in every set without a name, and rows
are flattened by them. How large they are nobody knows before. Names are asked beside forms as
large as they are known to be; how sure a name is, beside forms of every size, each as likely as its
evidence says (Bayesian model averaging: Hoeting et al. 1999).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import View
from bench.discrepancy.select.settings import FORM_SIZES
from bench.discrepancy.sets.believed import Believed, Unsure
from bench.discrepancy.sets.beside import varies
from bench.discrepancy.sets.blocks import Blocks, usual_levels
from bench.discrepancy.sets.choice import Choice
from bench.discrepancy.sets.choose import Contest
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.unsure import unsure
from bench.discrepancy.settings import MAD_TO_STD
from bench.physics.effect import Effect
from bench.physics.units import Floats


@dataclass(frozen=True)
class Ranged:
    """Residual ranges `left_m` [n] of the `known` rows, and what causes may do to them.

    `weights` [n] of rows; `raw` has the parts of causes in metres, `widest` see `Evidence`;
    `kinds`, `crowding` and `rows` see `Contest`.
    """

    left_m: Floats
    weights: Floats
    raw: Blocks
    widest: Mapping[str, float]
    kinds: Mapping[str, type[Effect]]
    crowding: float
    rows: View
    known: NDArray[np.intp]

    def beside(self, forms: Floats) -> Flattened:
        """Return the contest beside forms [n, k] with factors of one."""
        flat = whitening(self.weights[:, None] * forms, self._left) * self.weights
        blocks = {name: tuple(flat @ part for part in block) for name, block in self.raw.items()}
        evidence = Evidence(flat @ self.left_m, self.rows.links[self.known], blocks, self.widest)
        evidence.offset_mean = False  # what a receiver makes of all rows is in the forms
        return Flattened(
            evidence, self.kinds, self.crowding, self.rows, self.known, self.raw, flat, self.weights
        )

    def volume(self, forms: Floats) -> float:
        """Return what forms cost in nats: half the log determinant of what rows scatter by then."""
        return float(np.log1p(_ratios(self.weights[:, None] * forms, self._left)[1] ** 2).sum() / 2)

    @property
    def _left(self) -> Floats:
        return self.weights * self.left_m


class Flattened(Contest):
    """A contest on rows that `flat` [n, n] flattened; what causes do to ranges is said as it is.

    `raw` has the parts of causes as they are; `weights` [n] are those of rows in `flat`.
    """

    def __init__(
        self,
        evidence: Evidence,
        kinds: Mapping[str, type[Effect]],
        crowding: float,
        rows: View,
        known: NDArray[np.intp],
        raw: Blocks,
        flat: Floats,
        weights: Floats,
    ) -> None:
        super().__init__(evidence, kinds, crowding, rows, known, usual_levels(rows)[known])
        self.weights = weights
        self.raw = {name: np.hstack(block) for name, block in raw.items()}
        self.flat = flat

    def seen(self, columns: Floats) -> Floats:
        """Return what flattened rows show of columns [n, k]."""
        return np.asarray(self.flat @ columns)

    def bare(self, cause: str) -> Floats:
        """Return what a cause may do to the ranges of known rows [n, k], in metres."""
        flat = super().bare(cause)  # all there is of a law made here
        raw = self.raw.get(cause, flat)
        if raw.shape[1] != flat.shape[1]:  # its constants are an antenna delay's
            raw = raw[:, varies(self.seen(raw))]
        return raw


def whitening(forms: Floats, left_m: Floats) -> Floats:
    """Return the matrix [n, n] that makes rows alike where `forms` [n, k] add to their scatter.

    Every form has a normal factor of one; rows scatter as `left_m` [n] does.
    """
    ways, ratios = _ratios(forms, left_m)
    less = 1 - 1 / np.sqrt(1 + ratios**2)
    return np.asarray(np.eye(len(left_m)) - (ways * less) @ ways.T)


def _ratios(forms: Floats, left_m: Floats) -> tuple[Floats, Floats]:
    """Return the principal ways [n, k] of forms, and how much each is of what rows scatter by."""
    scatter = max(MAD_TO_STD * float(np.median(np.abs(left_m - np.median(left_m)))), 1e-4)
    ways, sizes, _ = np.linalg.svd(forms, full_matrices=False)
    return ways, sizes / scatter


def unsure_by_size(
    given: Ranged, forms: Floats, contest: Flattened, choice: Choice
) -> dict[str, Unsure]:
    """Return what else the names of a choice may do, beside forms of every size that is likely.

    The first set is that beside the smallest forms: beside none were the values fitted.
    """
    causes = (*choice.names, *choice.others)
    if not forms.size or not choice.names or not set(causes) <= {*given.raw}:
        return choice.unsure
    every = [_like(contest, given.beside(size * forms)) for size in FORM_SIZES]
    paid = [given.volume(size * forms) for size in FORM_SIZES]
    nats = np.array([e.evidence.of(causes).nats for e in every]) - paid
    shares = np.exp(nats - nats.max())
    shares /= shares.sum()
    return {
        name: _mixed([unsure(one, causes, name) for one in every], shares) for name in choice.names
    }


def _like(contest: Flattened, made: Flattened) -> Flattened:
    """Return a contest where rows weigh, and causes take part, as in another."""
    mine, other = made.evidence, contest.evidence
    mine.weights, mine.nearby = other.weights, other.nearby
    made.pays, made.fading = contest.pays, contest.fading
    made.able = tuple(one for one in contest.able if one in mine.places)
    return made


def _mixed(every: list[Unsure], shares: Floats) -> Unsure:
    """Return what contests say of one name, each with its share; those of other columns do not."""
    first = every[0]
    pairs = zip(every, shares, strict=True)
    alike = [(one, share) for one, share in pairs if one.columns.shape == first.columns.shape]
    total = sum(share for _, share in alike)
    sets: list[Believed] = []
    for one, share in alike:
        sets += [replace(made, share=made.share * share / total) for made in one.sets]
    return replace(first, sets=tuple(sets))
