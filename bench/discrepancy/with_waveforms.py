"""Whether waveforms take part: where both sides have them, and something differs in them.

A search of waveforms looks at hundreds of figures on a part of the links, and asks of what differs
in ranges what a detector may make of waveforms. Where these show nothing at all, ranges and levels
tell more by themselves: by all links, and with laws over all that is known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from bench.discrepancy.data.columns import has_waveforms, hidden
from bench.discrepancy.data.nominal_noise import untrue_logs
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.verdict import Unknown
from bench.physics.simulator import Simulator
from bench.recordings.table import CIR_COLUMNS, Recordings

if TYPE_CHECKING:
    from bench.discrepancy.diagnosis import Diagnosis, Options
    from bench.discrepancy.select.state import Selection

ALONE: Final = "waveforms show no difference: what is said is of ranges and levels by themselves"


def decided(asked: Options, recorded: Recordings, simulated: Simulator | Recordings) -> Options:
    """Return the options with what they leave open decided; without waveforms no CIR is seen."""
    if asked.waveform is not None:
        return asked if asked.waveform else replace(asked, hide=(*asked.hide, *CIR_COLUMNS))
    seen = [hidden(t.frame, asked.hide) for t in (recorded, simulated) if isinstance(t, Recordings)]
    hide = (*asked.hide, *untrue_logs(seen))
    return replace(asked, waveform=all(map(has_waveforms, seen)), hide=hide)


def or_without(made: Diagnosis, without: Callable[[], Diagnosis]) -> Diagnosis:
    """Return a diagnosis, or that `without` waveforms where these show nothing and it says more.

    More is a law, a fault of the set-up or a curve of what has no name. A name is none: what has
    one and shows in ranges alone was asked beside waveforms.
    """
    if not made.options.waveform or made.law or made.setup_fault or made.added:
        return made
    if not _of_ranges_alone(made.selection):
        return made
    other = without()
    says = other.law or other.setup_fault or other.added
    if other.selection.names or not says:
        return made
    return replace(other, counted=(*other.counted, ALONE))


def _of_ranges_alone(found: Selection) -> bool:
    """Return whether all that was found is of ranges, and without a name.

    Ranges may also speak for a cause beyond doubt that no place shows, and no name came of it.
    """
    seen = [finding for turn in found.rounds for finding in turn.located.findings]
    beyond = any(isinstance(one, Unknown) and not one.cause for one in found.verdicts)
    of_ranges = all(f.cell.observable == RANGE for f in seen)
    return (bool(seen) or beyond) and not found.names and of_ranges
