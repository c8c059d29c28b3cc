"""What an effect is: parameters with units and bounds, a source, a stage and one `apply`.

A third party writes

    @dataclass(frozen=True)
    class Warmth(Effect):
        '''Range drifts with temperature.'''

        name = "warmth"
        stage = "ranging"
        source = "my data sheet, p. 3"
        slope_m_per_c: float = parameter(0.002, "m/degC", -0.02, 0.02, "drift per degree")

        def apply(self, batch, draws):
            warm = batch.rows.number("temperature_c", 25.0) - 25.0
            return batch.longer(self.slope_m_per_c * warm)

and registers it under the entry-point group `bench.effects`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from math import isfinite
from typing import Any, ClassVar, Literal, cast

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError, unknown_name
from bench.physics.batch import Batch
from bench.physics.randomness import Draws
from bench.physics.scene import Scene

Stage = Literal["propagation", "receiver", "ranging"]
STAGES: tuple[Stage, ...] = ("propagation", "receiver", "ranging")


@dataclass(frozen=True)
class Parameter:
    """One parameter: unit, physical bounds, and the value at which it does nothing, if any.

    `whole` parameters are counts or switches: nothing to be fitted by small steps. `fitted` False:
    a search leaves it at its default.
    """

    name: str
    unit: str
    low: float
    high: float
    default: float
    meaning: str
    null: float | None
    whole: bool = False
    fitted: bool = True


def parameter(
    default: float,
    unit: str,
    low: float,
    high: float,
    meaning: str,
    *,
    null: float | None = None,
    fitted: bool = True,
) -> Any:
    """Return a dataclass field that carries its unit, bounds and meaning."""
    facts = {"unit": unit, "low": low, "high": high, "meaning": meaning, "null": null}
    return field(default=default, metadata={**facts, "fitted": fitted})


def describe(kind: type[Any]) -> tuple[Parameter, ...]:
    """Return the parameters of a dataclass made with `parameter` fields; read once."""
    if kind not in _DESCRIBED:
        _DESCRIBED[kind] = _parameters(kind)
    return _DESCRIBED[kind]


_DESCRIBED: dict[type[Any], tuple[Parameter, ...]] = {}


def _parameters(kind: type[Any]) -> tuple[Parameter, ...]:
    """Return `describe`, read from the fields."""
    return tuple(
        Parameter(
            name=item.name,
            default=float(cast(float, item.default)),
            whole=item.type in (int, "int"),
            **item.metadata,
        )
        for item in fields(kind)
        if "unit" in item.metadata
    )


def check_bounds(owner: str, values: Any) -> None:
    """Raise BenchError where a parameter of dataclass `values` is no number or out of bounds."""
    for item in describe(type(values)):
        value = getattr(values, item.name)
        where = f"{owner}: {item.name} = {value!r}"
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
            raise BenchError(f"{where}, expected a number in {item.unit}")
        if item.whole and value != int(value):
            raise BenchError(f"{where}, expected a whole number ({item.unit})")
        if not item.low <= value <= item.high:
            bounds = f"{item.low:g} to {item.high:g} {item.unit}"
            raise BenchError(f"{where} {item.unit} is outside its physical bounds, {bounds}")


@dataclass(frozen=True)
class Effect(ABC):
    """One physical effect on a batch of rows.

    Class attributes: `name` (its entry point), `number` (in the documentation's list), `stage`,
    `source` (where model and magnitudes come from), `signature` (what it does to recordings, in
    words), `control` (when it must vanish, in words, or "" where no such rows exist).
    `per_link`: it draws every link anew, so it can stand in for simpler effects.
    `fitted`: its parameters are fitted by a search; `explains`: the physics it stands for, where
    that is not its own name.
    `contains`: physics that it can do as well, as a special case.
    `last`: it acts on what the other effects of its stage made, so it comes behind them; `first`:
    it comes before them.
    `independent`: it scatters every row by itself, so it leaves no offset that a link keeps.
    `by_rows`: what it does to a waveform is drawn anew for every row, so scatter tells more of it
    than means do.
    `stackable`: what it does to a row follows from that row and its draws alone, all drawn by the
    methods of `draws`, so that several replicates may be given it as one batch (see
    `bench.physics.stacked`); said by every class for itself, not inherited.
    `marked`: it is fitted only where recordings bear a mark that no scatter can leave.
    `without_cir`: it also acts on rows simulated without a waveform; `on_tables`: it also acts
    meaningfully on the rows of another simulator's table (see `bench.physics.foreign`), where
    `with_phases` asks for phases that a table of magnitudes has not.
    `follows`: the measured column that its error follows, at a fixed distance too.
    `by_device`: every device has a size of its own of it, that comes and goes as nothing foretells.
    `by_kind`: every kind of obstacle has a size of its own of it, and every one of a kind another,
    as materials and thicknesses are rarely known.
    `own_curve`: what it does over the level is every receiver's own, so any curve is a form of it.
    `own_form`: what it does hangs on what nobody lists, as surfaces, so a mark by which it is seen
    does not tell its form.
    `jumps`: by it detected first paths jump from row to row, as far as a receiver's detector says.
    `dies_away`: of what it adds there is never more the later it is, once it has begun.
    `at_one_delay`: what it adds comes at the same delays in all links.
    `told_by`: the measurement that tells it from others of which the same is said, "" without one.
    `of_levels`: parameters that levels and waveforms tell, and ranges alone do not; `of_phases`:
    those that phases alone tell, and no power. `logged_as`: the column in which receivers log this
    alone, "" without one. `resembles`: the effect that does the same to many links together, so
    that where its places are not known these two are not told apart, "" without one.
    `seldom`: the amplitude, from zero on, of what few do: it is fitted without it, too, "" if none.
    `adds`: the parameter by which it adds to what there is: below its null it would take away,
    which nothing does that a simulator leaves out; "" without one.
    `everywhere`: clocks, delays and time stamps make it, so it is the same wherever radios stand.
    `needs`: columns without which a table says nothing about it, as alternatives that each are
    enough. `strikes`: the names of the parameters for the share of the links it strikes at random
    and for how hard, where it does; `struck_level`: that for the level in dB of what arrives there,
    over the free straight path. `silent_before`: where it strikes nothing arrives before the
    path that is detected. `setup_fault`: the kind of fault of the set-up that it is, such
    as a time shift: nothing of the radio, but of how it was measured. `essential`: parameters
    without which it is another effect; `essential_with_cir`, `essential_on_paths`: more of them,
    where waveforms are compared, and where they are not. `instead`: parameters any of which does
    for all of these. `held`: fields beside these that no search over parameters changes. `begins`:
    other values of parameters, from which a search in waveforms begins as from the defaults.
    """

    name: ClassVar[str]
    stage: ClassVar[Stage]
    source: ClassVar[str]
    number: ClassVar[int] = 0
    signature: ClassVar[str] = ""
    control: ClassVar[str] = ""
    per_link: ClassVar[bool] = False
    fitted: ClassVar[bool] = True
    explains: ClassVar[str] = ""
    contains: ClassVar[tuple[str, ...]] = ()
    last: ClassVar[bool] = False
    first: ClassVar[bool] = False
    independent: ClassVar[bool] = False
    by_rows: ClassVar[bool] = False
    marked: ClassVar[bool] = False
    follows: ClassVar[str] = ""
    by_device: ClassVar[bool] = False
    by_kind: ClassVar[bool] = False
    own_curve: ClassVar[bool] = False
    own_form: ClassVar[bool] = False
    jumps: ClassVar[bool] = False
    dies_away: ClassVar[bool] = False
    at_one_delay: ClassVar[bool] = False
    told_by: ClassVar[str] = ""
    of_levels: ClassVar[tuple[str, ...]] = ()
    of_phases: ClassVar[tuple[str, ...]] = ()
    resembles: ClassVar[str] = ""
    logged_as: ClassVar[str] = ""
    seldom: ClassVar[str] = ""
    begins: ClassVar[tuple[Mapping[str, float], ...]] = ()
    adds: ClassVar[str] = ""
    everywhere: ClassVar[bool] = False
    stackable: ClassVar[bool] = False
    without_cir: ClassVar[bool] = True
    on_tables: ClassVar[bool] = True
    with_phases: ClassVar[bool] = False
    needs: ClassVar[tuple[tuple[str, ...], ...]] = ()
    strikes: ClassVar[tuple[str, str] | None] = None
    struck_level: ClassVar[str] = ""
    silent_before: ClassVar[bool] = False
    values_unit: ClassVar[str] = ""
    setup_fault: ClassVar[str] = ""
    essential: ClassVar[tuple[str, ...]] = ()
    essential_with_cir: ClassVar[tuple[str, ...]] = ()
    essential_on_paths: ClassVar[tuple[str, ...]] = ()
    instead: ClassVar[tuple[str, ...]] = ()
    held: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        check_bounds(f"effect {self.name!r}", self)

    @property
    def physics(self) -> str:
        """The library's name for what this effect does."""
        return self.explains or self.name

    @abstractmethod
    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Return the batch with the effect in it. Never writes into the arrays it is given."""

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows [n] on which the effect must do nothing: its negative control."""
        return np.zeros(len(batch.rows), bool)

    @classmethod
    def lacking(cls, columns: Collection[str]) -> str:
        """Return in words what it needs that these columns lack, "" where nothing is."""
        if not cls.needs or any(set(way) <= set(columns) for way in cls.needs):
            return ""
        return ", or ".join(" and ".join(c for c in way if c not in columns) for way in cls.needs)

    @classmethod
    def unmarked(cls, frame: pd.DataFrame) -> str:  # noqa: ARG003
        """Return in words the mark it always leaves that recorded rows lack, "" where none does."""
        return ""

    @classmethod
    def by_mark(cls, frame: pd.DataFrame) -> tuple[Effect, ...]:  # noqa: ARG003
        """Return the forms of the effect that a mark in recorded rows leaves open.

        None where it leaves no mark of its own, or one too faint to matter.
        """
        return ()

    @classmethod
    def hinted(cls, frame: pd.DataFrame) -> bool:
        """Return whether rows may bear the mark, if faintly: then another table's is no news."""
        return bool(cls.by_mark(frame))

    def borne_by(self, frame: pd.DataFrame) -> bool:
        """Return whether the rows of another table bear the mark of this effect, as it is."""
        return False

    @classmethod
    def fit_values(cls, frame: pd.DataFrame, residual_m: NDArray[np.float64]) -> Effect | None:  # noqa: ARG003
        """Return the effect with values per device (or level, or place) that fit recorded rows.

        `frame` [n] as known to a simulator, `residual_m` [n] recorded minus simulated range (NaN =
        unknown). None where the rows support none, and for effects without such values.
        """
        return None

    def values(self) -> dict[str, float]:
        """Return the fitted values by name, in `values_unit`; none where parameters are all."""
        return {}

    @classmethod
    def ways(cls, rows: Scene) -> tuple[NDArray[np.float64], ...] | None:  # noqa: ARG003
        """Return what it can do to the ranges of these rows, to first order: columns [n, k].

        In metres, each as large as physics lets it typically be, so that factors around 1 make
        every form of the effect; parts [n, k] that may be of quite other sizes stand by themselves.
        None where that cannot be said.
        """
        return None

    @classmethod
    def logged_ways(cls, rows: Scene) -> tuple[NDArray[np.float64], ...]:  # noqa: ARG003
        """Return the columns [n, k] in metres that a log says it does; none without such a log."""
        return ()

    @classmethod
    def possible(cls, rows: Scene, shift_m: NDArray[np.float64]) -> bool:  # noqa: ARG003
        """Return whether physics allows what it is said to do to the ranges [n] of these rows."""
        return True

    @classmethod
    def told_beyond(cls, rows: Scene) -> NDArray[np.float64] | None:  # noqa: ARG003
        """Return what anything else may do that looks like it: columns [n, k]; None for nothing.

        Beyond these it is told by a form of its own, however much of them its ways can do, too.
        """
        return None

    @classmethod
    def like(cls, rows: Scene, shift_m: NDArray[np.float64]) -> dict[str, float]:  # noqa: ARG003
        """Return values with which it does about so much to ranges [n], in metres; or none."""
        return {}

    def forms(self) -> tuple[Effect, ...]:
        """Return the forms that its mark cannot tell apart, the simplest first."""
        return (self,)

    def not_told_from(self, alike: tuple[Effect, ...]) -> Effect:
        """Return it with what is known of its forms that recordings speak for as much."""
        return self

    def forms_as_likely(self) -> tuple[Effect, ...]:
        """Return other forms of it that recordings speak for as much, as far as that is known."""
        return ()

    def leant_m(self, rows: Scene) -> NDArray[np.float64]:
        """Return what its mark does to the ranges of rows [n] in the mean, in metres."""
        return np.zeros(len(rows))

    @property
    def chosen_nats(self) -> float:
        """What it costs in nats that this form was chosen among many, as the data have it."""
        return 0.0

    @classmethod
    def tellable(cls, rows: Scene) -> bool:  # noqa: ARG003
        """Return whether these rows vary what it follows: else it may only stand beside another."""
        return True

    @property
    def freed(self) -> int:
        """How many values a fit sets free: what its gain has to pay for."""
        return len(self.values()) or sum(p.fitted and p.high > p.low for p in self.parameters())

    @classmethod
    def parameters(cls) -> tuple[Parameter, ...]:
        """Return its parameters with unit, bounds and meaning."""
        return describe(cls)

    @classmethod
    def from_values(cls, values: dict[str, Any]) -> Effect:
        """Return the effect with these parameter values. Raises BenchError on a wrong one."""
        known = [item.name for item in fields(cls)]
        for given in values:
            if given not in known:
                raise unknown_name(f"parameter of effect {cls.name!r}:", given, known)
        return cls(**values)
