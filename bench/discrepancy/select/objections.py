"""Why what gained most is no name after all: words for the report."""

from __future__ import annotations

from bench.discrepancy.compare.view import Added
from bench.discrepancy.select.refute import fits, swapped_for
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.undetermined import undetermined, untold
from bench.discrepancy.select.verdict import LeftOut
from bench.physics.effect import Effect


def objection(search: Search, turn: Round, added: Added, effect: Effect, option: LeftOut) -> str:
    """Return why an option for `effect` is no name, "" where it may be.

    `effect` itself is known to reproduce what it acts on. How much independent scatter there is
    rows of one link have told; how it parts into a width and a share of wide rows need not be,
    but where a grid is there, of which another form scatters too.
    """
    name = option.names[0]
    if option.control.passed is False:
        return f"{name} gains most, but it is there too in {option.control.words}"
    if option.effect is effect and any(effect.name == one.name for one in search.logged):
        return ""
    if option.effect is effect and loses_by_itself(option):
        return f"looks most like {name}, but held-out links are worse with it"
    if untold(option):
        return f"looks most like {name}, but none of its values is told from zero"
    of_set = {
        *search.choice.names,
        *(one for some in search.choice.rivals.values() for one in some),
    }
    told = type(option.effect).independent and not any(type(one).marked for one in added)
    weighed = search.fit.waveform or name in of_set or told
    if not weighed and undetermined(option):
        return f"looks most like {name}, but these recordings determine none of its values"
    if option.effect is effect or name in search.choice.constants_m:  # weighed at usual levels
        return ""
    found = fits(search, swapped_for(added, effect, option.effect), option.effect, turn)
    return "" if found.adequate else found.against(name)


def loses_by_itself(option: LeftOut) -> bool:
    """Return whether held-out links are surely worse with what shifts ranges.

    Scatter, and a grid that ranges lie on, are seen by themselves: of these no score decides.
    """
    kind = type(option.effect)
    return option.gain.high < 0 and not (kind.independent or kind.marked)
