"""Sets that fit worse than a set which they contain are fitted on from it.

With more parameters nothing fits worse: such a fit ended elsewhere, and what the larger set has
more would seem to bring nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.growth import Fits
from bench.discrepancy.joint.polish import Fit, key_of
from bench.discrepancy.joint.settings import MOST, NAME_NATS
from bench.discrepancy.joint.statistics import Statistics


class Nested:
    """The known `fits` of sets, by the names of a set; `fit` fits more sets and keeps the best."""

    def __init__(
        self, given: Statistics, fits: Fits, fit: Callable[[Iterable[Added]], object]
    ) -> None:
        self.given, self.fits, self._fit = given, fits, fit
        self._done: set[tuple[Added, Added]] = set()

    def likeliest(self, likeliest: Callable[[Iterable[Fit]], Fit]) -> Fit:
        """Return the likeliest set, once those with one member more were fitted on from it."""
        best = likeliest(self.fits.values())
        for _ in range(MOST):
            self.wider(best)
            before, best = best, likeliest(self.fits.values())
            if best is before:
                break
        return best

    def wider(self, best: Fit) -> list[Fit]:
        """Return the sets with more members than the best that became likelier by this."""
        larger = [fit for key, fit in self.fits.items() if key_of(best.effects) < key]
        self._all_on(best, larger)
        made = [(fit, self.on(best, fit)) for fit in larger]
        return [now for before, now in made if now.nats > before.nats]

    def _all_on(self, rest: Fit, larger: Sequence[Fit]) -> None:
        """Fit sets on from their `rest` beside one another, as `on` does with each."""
        new = [fit for fit in larger if (rest.effects, fit.effects) not in self._done]
        worse = [fit for fit in new if fits_worse(self.given, rest, fit)]
        if worse:
            self._fit([(*rest.effects, *_more(rest, fit)) for fit in worse])
        self._done |= {(rest.effects, fit.effects) for fit in new}

    def on(self, rest: Fit, fit: Fit) -> Fit:
        """Return a set, fitted on from its `rest` if it fits worse than that; each pair once."""
        pair = rest.effects, fit.effects
        if pair not in self._done and fits_worse(self.given, rest, fit):
            self._fit([(*rest.effects, *_more(rest, fit))])
        self._done.add(pair)
        return self.fits.get(key_of(fit.effects), fit)


def fits_worse(given: Statistics, rest: Fit, fit: Fit) -> bool:
    """Return whether a set with one member more fits worse than its `rest`, by what a name brings.

    `nats` have the price of parameters in them (BIC), which says nothing of how a set fits.
    """
    price = (fit.parameters - rest.parameters) / 2 * float(np.log(given.links))
    alone = not rest.effects or len(_more(rest, fit)) != 1
    return not alone and fit.nats + price < rest.nats - NAME_NATS


def _more(rest: Fit, fit: Fit) -> Added:
    """Return the members of a set that its `rest` has not."""
    return tuple(effect for effect in fit.effects if effect.name not in rest.names)
