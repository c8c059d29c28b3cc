"""Real recordings with the revealing columns hidden, and those columns used only to check.

Each case returns what was said and a list of checks with the bar, the value and whether it is met.
"""

from bench.challenge.real.case import Check, RealCase, first_named
from bench.challenge.real.ghent_case import ghent
from bench.challenge.real.miluv_case import miluv
from bench.challenge.real.outdoor_case import outdoor

__all__ = ["Check", "RealCase", "first_named", "ghent", "miluv", "outdoor"]
