"""The evidence of a set of causes: how probable recorded ranges are if only these act.

Every cause is a block of columns with normal factors, those of a part of one size; rows scatter,
and links keep offsets that no cause explains, whose mean is as unknown as they scatter around it:
what stands in the way of some links lengthens all in the mean, and is no constant. Sizes and
scatter are those of most evidence (MacKay 1992), so a cause pays for every freedom that it has.
Rows far off weigh less (Student's t), links far off nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.grouped import group_sums
from bench.discrepancy.law.settings import LAW_TAIL
from bench.discrepancy.sets.believed import Believed
from bench.discrepancy.sets.likeliest import Form, Products, inverse_root, likeliest
from bench.discrepancy.sets.settings import (
    ANY_MEAN,
    FEWEST_BEHIND,
    FIRST_RATIO,
    LARGE_OFFSETS,
    LEAST_VARIANCE_M2,
    LEAST_WEIGHT,
    LEAST_WIDER,
    MOST_WIDER,
    NAME_NATS,
    NOTHING,
    OFFSET_RATIOS,
    OWN_OFFSETS,
    REWEIGHINGS,
    ROWS_PER_LINK,
    SIZE_BOUNDS,
    SMALLEST_STEP_NATS,
    STRAY_LINK_M,
    STRAY_LINK_STD,
)
from bench.discrepancy.settings import MAD_TO_STD

Floats = NDArray[np.float64]
Parts = tuple[Floats, ...]
Columns = Mapping[str, Parts]


@dataclass(frozen=True)
class Weighed:
    """A set with its log evidence in nats, the factors [k] of its columns and their covariance.

    `places` [k] are its columns, `sizes` [k] the variances that their factors have before;
    `variance_m2` that of rows, `ratio` that of link offsets to it.
    """

    causes: tuple[str, ...]
    nats: float
    places: NDArray[np.intp]
    sizes: Floats
    factors: Floats
    covariance: Floats
    variance_m2: float
    ratio: float


class Evidence:
    """Residual ranges `left_m` [n] of rows of `links` [n], and parts [n, k] of causes by name.

    `widest` maps causes to the largest variance of their factors, where it is not the usual.
    `offset_mean`: whether the mean of link offsets is unknown, which takes several rows of a link;
    `scatter_m2`: variance of simulated ranges, that large offsets are measured by, and `links_m2`
    that of simulated links among each other; `behind` [L]: links with something in the way, whose
    offsets may be `wider` than the others', in variance.
    """

    def __init__(
        self,
        left_m: Floats,
        links: NDArray[np.intp],
        blocks: Columns,
        widest: Mapping[str, float] | None = None,
    ) -> None:
        self.left_m, self.blocks = left_m, dict(blocks)
        self.links = np.unique(links, return_inverse=True)[1]
        parts = [part for block in self.blocks.values() for part in block]
        self.columns = np.hstack([np.empty((len(left_m), 0)), *parts])
        self.widths = {name: [p.shape[1] for p in block] for name, block in self.blocks.items()}
        ends = np.cumsum([0, *(sum(width) for width in self.widths.values())])
        pairs = zip(self.blocks, ends, ends[1:], strict=False)
        self.places = {name: np.arange(a, b) for name, a, b in pairs}
        self.widest = dict(widest or {})
        self.offset_mean = len(left_m) >= ROWS_PER_LINK * len(np.unique(links))
        self.scatter_m2, self.links_m2 = np.inf, 0.0
        self.behind = np.zeros(self.links.max(initial=-1) + 1, np.bool_)
        self.wider = np.ones(len(self.behind))
        self.mean_ratio = 0.0  # variance of that mean over the rows', as `reweigh` finds it
        self.weights = np.ones(len(left_m))
        self.nearby = FIRST_RATIO  # place of the ratio from which the best is sought
        self._products: dict[float, tuple[Floats, float]] = {}

    def with_blocks(self, blocks: Columns) -> Evidence:
        """Return the evidence of other blocks, every row with the weight that it has here."""
        made = Evidence(self.left_m, self.links, blocks, self.widest)
        made.weights, made.nearby = self.weights, self.nearby
        made.offset_mean, made.mean_ratio = self.offset_mean, self.mean_ratio
        made.scatter_m2, made.links_m2 = self.scatter_m2, self.links_m2
        made.behind, made.wider = self.behind, self.wider
        return made

    def lie_behind(self, rows: NDArray[np.bool_]) -> None:
        """Say which rows [n] have something in the way: their links may keep larger offsets."""
        self.behind = np.bincount(self.links, rows) > 0

    def among(self, rows: NDArray[np.bool_]) -> Evidence:
        """Return the evidence of some rows [n]: the others take no part."""
        made = self.with_blocks(self.blocks)
        made.weights = np.where(rows, self.weights, NOTHING)
        return made

    def toward(self, target_m: Floats) -> Evidence:
        """Return the evidence of other residual ranges [n] in the same rows."""
        made = self.with_blocks(self.blocks)
        made.left_m = target_m
        return made

    def reweigh(self, causes: Sequence[str]) -> int:
        """Give rows and links the weights that they have beside a set of causes.

        Begins with all rows alike: of what was far off beside another set nothing would be learnt,
        and it would stay so beside one that explains it. Returns how many links take no part.
        """
        self.mean_ratio, stray, self._products = 0.0, 0, {}
        self.weights, self.wider = np.ones(len(self.left_m)), np.ones(len(self.behind))
        for _ in range(REWEIGHINGS):
            best = self.of(causes)
            self.nearby = OFFSET_RATIOS.index(best.ratio)
            left = self.left_m - self.columns[:, best.places] @ best.factors
            far = self._stray(left)
            self.wider = self._widths(left, far)
            near, stray = ~far[self.links], int(far.sum())
            left = left - self._offsets(left, best.ratio)[self.links]
            z2 = left**2 / best.variance_m2
            self.weights = np.where(near, (LAW_TAIL + 1) / (LAW_TAIL + z2), NOTHING)
            self._products = {}
        if self.offset_mean:
            self.mean_ratio = self._around_mean(causes)
        return stray

    def _around_mean(self, causes: Sequence[str]) -> float:
        """Return the ratio of link offsets around a mean that may be anything; 0 where it is small.

        A constant alone must not pass for offsets, whose mean it would then be. What jitter adds to
        rows makes no offsets smaller: of the two scatters, recorded and simulated, the less counts.
        Nor are offsets large that simulated links have of their own, whose mean is no longer one.
        """
        other = self.with_blocks({one: self.blocks[one] for one in causes})
        other.mean_ratio = ANY_MEAN
        made, (none,) = other.of(causes), other.at([causes], 0.0)
        least = LARGE_OFFSETS * min(made.variance_m2, self.scatter_m2)
        least = max(least, OWN_OFFSETS * self.links_m2)
        sure = made.nats - none.nats > NAME_NATS  # loud rows leave links offsets by chance
        return made.ratio if sure and made.ratio * made.variance_m2 >= least else 0.0

    def _stray(self, left_m: Floats) -> NDArray[np.bool_]:
        """Return which links [L] are struck by something of their own."""
        middle = self._middle(left_m)
        scale = float(np.median(np.abs(middle))) * MAD_TO_STD
        return np.asarray(np.abs(middle) > max(STRAY_LINK_M, STRAY_LINK_STD * scale))

    def _middle(self, left_m: Floats) -> Floats:
        """Return the median of every link [L], beside the median of links."""
        middle = np.array([np.median(left_m[self.links == i]) for i in range(self.links.max() + 1)])
        return np.asarray(middle - np.median(middle))

    def _widths(self, left_m: Floats, far: NDArray[np.bool_]) -> Floats:
        """Return how much wider offsets of links are [L], in variance: 1 in sight, more behind.

        Walls, edges and detours are of every link's own; where both sides have them, they say
        nothing of what devices or the distance do. Of links that are not `far` off [L].
        """
        some = self.behind & ~far, ~self.behind & ~far
        if min(part.sum() for part in some) < FEWEST_BEHIND:
            return np.ones(len(self.behind))
        middle = self._middle(left_m)
        behind, sight = (float(np.mean(middle[part] ** 2)) for part in some)
        times = behind / max(sight, LEAST_VARIANCE_M2)
        return np.where(self.behind, min(times, MOST_WIDER) if times > LEAST_WIDER else 1.0, 1.0)

    def _offsets(self, left_m: Floats, ratio: float) -> Floats:
        """Return the likeliest offset of every link [L]."""
        weight, ratios = np.bincount(self.links, self.weights), ratio * self.wider
        return np.bincount(self.links, self.weights * left_m) * ratios / (1 + ratios * weight)

    def of(self, causes: Sequence[str]) -> Weighed:
        """Return a set with its evidence, at its own best ratio of link offsets.

        At that of another set, offsets that links keep would count as evidence for a cause.
        """
        return self.of_all([causes])[0]

    def of_all(self, sets: Sequence[Sequence[str]]) -> list[Weighed]:
        """Return `of` of several sets: the same, in less time."""
        best = self.at(sets, OFFSET_RATIOS[self.nearby])
        still = list(range(len(sets)))
        for step in (-1, 1):
            moved = self._moved(best, still, step)
            still = [number for number in still if number not in moved]
        return best

    def _moved(self, best: list[Weighed], numbers: Sequence[int], step: int) -> set[int]:
        """Move some of the sets on, ratio by ratio, while they get better; return which moved."""
        place, moved = self.nearby + step, set[int]()
        while numbers and 0 <= place < len(OFFSET_RATIOS):
            others = self.at([best[n].causes for n in numbers], OFFSET_RATIOS[place])
            pairs = zip(numbers, others, strict=True)
            better = {n: other for n, other in pairs if not other.nats <= best[n].nats}
            for n, other in better.items():
                best[n] = other
            numbers, place = list(better), place + step
            moved |= better.keys()
        return moved

    def response(self, made: Weighed, cause: str) -> Floats:
        """Return what one cause of a set does to the range of every row [n], in metres."""
        return np.asarray(self.columns[:, self.places[cause]] @ self.factors(made, cause))

    def factors(self, made: Weighed, cause: str) -> Floats:
        """Return the factors [k] of one cause of a set."""
        return made.factors[np.isin(made.places, self.places[cause])]

    def broadly(self, made: Weighed, cause: str, share: float = 1.0) -> Believed:
        """Return what a set says of the factors of a cause, with a share of belief.

        Before, causes have at least the size that is typical: that of most evidence is none where
        another cause does the same, though either may do it.
        """
        product, mine = self._product(made.ratio)[0], np.isin(made.places, self.places[cause])
        told = product[np.ix_(made.places, made.places)] / made.variance_m2
        before = 1 / np.maximum(made.sizes, 1.0)
        right = product[made.places, -1] / made.variance_m2
        factors = np.linalg.solve(told + np.diag(before), right)
        return Believed(share, np.asarray(factors[mine], np.float64), told, before, mine)

    def _product(self, ratio: float) -> tuple[Floats, float]:
        """Return X' V^-1 X of all columns, the residual last, and log |V|, rows of variance 1."""
        if ratio not in self._products:
            ones = np.ones(len(self.left_m))
            every = np.column_stack([self.columns, self.left_m, ones])
            weighed = every * self.weights[:, None]
            weight = np.bincount(self.links, self.weights)
            sums = group_sums(weighed, self.links, len(weight))
            ratios = ratio * self.wider
            shrink = ratios / (1 + ratios * weight)
            product = every.T @ weighed - (sums * shrink[:, None]).T @ sums
            wide = self.mean_ratio
            of_mean, own = product[:-1, -1], wide / (1 + wide * product[-1, -1])
            log = float(np.log1p(ratios * weight).sum() - np.log(self.weights).sum())
            log += float(np.log1p(wide * product[-1, -1]))
            self._products[ratio] = product[:-1, :-1] - own * np.outer(of_mean, of_mean), log
        return self._products[ratio]

    def nearest(self, cause: str, made: Weighed) -> tuple[float, Floats]:
        """Return how far one value of a cause is from the ranges, in nats, and what it does [n].

        One value only: many together follow nearly everything, which is no reason to name them.
        Rows and links scatter as in `made`; the value pays for a size beyond what is typical.
        """
        product, places = self._product(made.ratio)[0] / made.variance_m2, self.places[cause]
        right = product[places, -1]
        factors = right / (np.diag(product)[places] + 1 / SIZE_BOUNDS[1])
        best = int(np.argmax(factors * right))
        far = float(product[-1, -1] - factors[best] * right[best])
        return far / 2, np.asarray(self.columns[:, places[best]] * factors[best])

    def at(self, sets: Sequence[Sequence[str]], ratio: float) -> list[Weighed]:
        """Return sets with their evidence at one ratio of link offsets."""
        if not sets:
            return []
        product, log = self._product(ratio)
        forms = [self._form(tuple(causes)) for causes in sets]
        given = [_products(product, form.places) for form in forms]
        square = float(product[-1, -1])
        count = max(float(np.count_nonzero(self.weights > LEAST_WEIGHT)), 2.0)
        best = likeliest(forms, given, square, count)
        every = zip(forms, given, best, strict=True)
        return [_weighed(*one, square, count, log, ratio) for one in every]

    def _form(self, causes: tuple[str, ...]) -> Form:
        """Return what a set of causes is made of."""
        places = np.concatenate([np.empty(0, np.intp), *(self.places[c] for c in causes)])
        widths = [(c, width) for c in causes for width in self.widths[c]]
        owner = np.repeat(np.arange(len(widths)), [width for _, width in widths])
        most = np.array([self.widest.get(c, SIZE_BOUNDS[1]) for c, _ in widths])
        begin = np.flatnonzero(np.diff(owner, prepend=-1))
        return Form(causes, places.astype(np.intp), owner, begin, most)


def _products(product: Floats, places: NDArray[np.intp]) -> Products:
    """Return the products of some of all columns, of which the residual is the last."""
    return Products(product[np.ix_(places, places)], product[places, -1])


def _weighed(
    form: Form,
    given: Products,
    best: tuple[Floats, float],
    square: float,
    count: float,
    log: float,
    ratio: float,
) -> Weighed:
    """Return a set with its evidence, at the sizes and the variance of most evidence.

    `log` is log |V| of rows of variance 1; `square`, `count`: see `likeliest`.
    """
    sizes, variance = best
    root = inverse_root(given.inner / variance, (1 / sizes).take(form.owner))
    covariance = root.T @ root
    factors = covariance @ given.right / variance
    quadratic = (square - factors @ given.right) / variance
    volume = float(np.log(sizes[form.owner]).sum() - 2 * np.log(root.diagonal()).sum())
    nats = -0.5 * (count * np.log(2 * np.pi * variance) + log + volume + quadratic)
    nats -= SMALLEST_STEP_NATS * len(form.causes)
    of_columns = sizes[form.owner]
    return Weighed(
        form.causes, float(nats), form.places, of_columns, factors, covariance, variance, ratio
    )
