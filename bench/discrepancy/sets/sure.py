"""Whether ranges speak for a name so surely that no place need stand out."""

from __future__ import annotations

from bench.discrepancy.sets.choice import Choice
from bench.discrepancy.sets.settings import SEEN_NATS


def beyond_doubt(choice: Choice) -> bool:
    """Return whether ranges speak for a name of a set so surely that no place need stand out.

    A search looks at means over intervals of one number at a time. What goes up and down over two
    of them, or by a product of two, moves none of these by much; an effect knows its own shape.
    """
    return max((choice.nats[one] for one in choice.names), default=0.0) >= SEEN_NATS
