"""What a diagnosis is asked, and what it says in the end."""

from __future__ import annotations

from dataclasses import dataclass, field

from bench.discrepancy.compare.view import Added
from bench.discrepancy.confirm import Confirmed
from bench.discrepancy.data.split import LinkSplit
from bench.discrepancy.headline import NEW_SIMULATOR, NEW_TABLE, headline, or_elsewhere
from bench.discrepancy.law.found import FoundLaw, SetupFault
from bench.discrepancy.law.named_faults import without_a_name
from bench.discrepancy.report.evidence import Evidence
from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.unnamed import curve_words
from bench.physics.base import Base
from bench.physics.simulator import Simulator


@dataclass(frozen=True)
class Options:
    """How much is done: rows used for search, fit and confirmation, the seed, what is compared.

    `measured` and `known` say of columns of the user's own which they are (see `own_columns`).
    `waveform` False simulates from paths alone (see `View`); None decides by the tables: waveforms
    are compared where both sides have them.
    """

    seed: int = 0
    search_rows: int = 2000
    fit_rows: int = 500
    confirm_rows: int = 2000
    hide: tuple[str, ...] = ()
    measured: tuple[str, ...] = ()
    known: tuple[str, ...] = ()
    observables: tuple[str, ...] | None = None
    waveform: bool | None = None


@dataclass(frozen=True)
class Diagnosis:
    """A finished diagnosis; `simulator` has the effects added, None where a table was compared.

    `mix` maps covariates to what differs in their mix (see `TableComparison.mix`); `uncovered` is
    the share of the recorded rows that have no simulated counterpart and took no part; `base` has
    the radio settings that were taken from the recordings. `law` and `setup_fault` are said where
    no known effect explains what is there, and sealed links bear it out. `evidence` has working
    rows to go on from. `measured` are columns of the user's own that were measured with the range,
    so that they were not searched over. `links` counts those of the table, and those after links
    that hold a drive were cut into places (see `bench.recordings.places`). `counted` says how many
    rows each side has, and how many were left out for what.
    """

    source: str
    simulated: str
    selection: Selection
    added: Added
    confirmed: Confirmed
    split: LinkSplit
    simulator: Simulator | None
    mix: dict[str, tuple[float, float]] = field(default_factory=dict)
    options: Options = field(default_factory=Options)
    uncovered: float = 0.0
    base: Base = field(default_factory=Base)
    law: FoundLaw | None = None
    setup_fault: SetupFault | None = None
    evidence: Evidence | None = None
    measured: tuple[str, ...] = ()
    links: tuple[int, int] = (0, 0)
    counted: tuple[str, ...] = ()

    @property
    def recommended(self) -> bool:
        """Whether what was added serves on the sealed links (see `Confirmed.serves`)."""
        return bool(self.added) and self.confirmed.serves

    @property
    def headline(self) -> str:
        """One line to begin with: what was found, and whether the sealed links bear it out."""
        fault = without_a_name(self.setup_fault, self.selection)
        said = fault or self.law or curve_words(self.added)
        more = f"{said}{self.law.nearest if self.law else ''}" if said else ""
        found, added = self.selection, bool(self.added)
        now = NEW_SIMULATOR if self.simulator else NEW_TABLE
        line = headline(found.verdicts, added, self.confirmed, more, found.withheld, now)
        return line + or_elsewhere(found.names, found.elsewhere)
