"""A count on a part: latency, energy, and whether it fits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from bench.errors import BenchError
from bench.measure.profile import Coefficient, Profile
from bench.results import Cycles, Interval

_KIB = 1024


class Taken(Protocol):
    """What a call takes on a core, as `Count` and `bench.results.CountRecord` hold it."""

    @property
    def core(self) -> str:
        """The core counted on."""

    @property
    def cycles(self) -> Cycles:
        """Cycles by its table."""

    @property
    def flash_reads(self) -> int:
        """How often data is read from flash."""

    @property
    def flash_bytes(self) -> int:
        """Code, constants and initial values."""

    @property
    def ram_bytes(self) -> int:
        """Variables and stack."""


@dataclass(frozen=True)
class Figure:
    """One call on one part: latency (us) and energy (mJ) with low and high, COUNTED.

    `cycles` include the part's wait states on data read from flash. `fits` says in words what of
    flash and RAM it takes; `problem` is set where it takes more than the part has.
    """

    device: str
    cycles: Interval
    latency_us: Interval
    energy_mj: Interval | None
    fits: str
    problem: str | None


def figure_of(count: Taken, profile: Profile) -> Figure:
    """Return a count in a part's units. Raises BenchError where the profile has another core."""
    if profile.core != count.core:
        raise BenchError(f"{profile.name} has core {profile.core or 'none'}, counted {count.core}")
    cycles = _cycles(count, profile)
    latency_us = _over(cycles, profile.coefficients["frequency_mhz"])
    problem = _too_big(count, profile)
    return Figure(
        profile.name,
        cycles,
        latency_us,
        _energy_mj(cycles, latency_us, profile),
        _fits(count, profile),
        problem,
    )


def _cycles(count: Taken, profile: Profile) -> Interval:
    """Return the cycles with wait states, times the part's own factor where one was measured."""
    none = Coefficient(0, 0, 0, "", "", "assumed")
    one = Coefficient(1, 1, 1, "", "", "assumed")
    wait = profile.coefficients.get("flash_wait_cycles", none)
    factor = profile.coefficients.get("cycle_factor", one)
    if "cycle_factor" in profile.coefficients:  # measured: the table's spread is no longer unknown
        typical = count.cycles.typical + wait.value * count.flash_reads
        return Interval(typical * factor.value, typical * factor.low, typical * factor.high)
    return Interval(
        count.cycles.typical + wait.value * count.flash_reads,
        count.cycles.low + wait.low * count.flash_reads,
        count.cycles.high + wait.high * count.flash_reads,
    )


def _over(cycles: Interval, clock: Coefficient) -> Interval:
    low, high = _ends(cycles)
    return Interval(cycles.value / clock.value, low / clock.high, high / clock.low)


def _energy_mj(cycles: Interval, latency_us: Interval, profile: Profile) -> Interval | None:
    """Return the energy: per cycle where the part's is known so, else power times latency."""
    low, high = _ends(cycles)
    if (each := profile.coefficients.get("cycle_energy_pj")) is not None:
        return Interval(
            cycles.value * each.value * 1e-9, low * each.low * 1e-9, high * each.high * 1e-9
        )
    if (power := profile.coefficients.get("power_w")) is None:
        return None
    low, high = _ends(latency_us)
    return Interval(
        latency_us.value * power.value * 1e-3, low * power.low * 1e-3, high * power.high * 1e-3
    )


def _ends(figure: Interval) -> tuple[float, float]:
    low = figure.value if figure.low is None else figure.low
    return low, figure.value if figure.high is None else figure.high


def _fits(count: Taken, profile: Profile) -> str:
    flash, ram = profile.value("flash_kib"), profile.value("ram_kib")
    if problem := _too_big(count, profile):
        return problem
    if flash is None and ram is None:
        return (
            f"takes {_whole(count.flash_bytes)} KB for the file, {_whole(count.ram_bytes)} KB RAM"
        )
    used = f"{_whole(count.flash_bytes)} of {_of(flash)} flash, {_whole(count.ram_bytes)} of"
    return f"fits: {used} {_of(ram)} RAM"


def _too_big(count: Taken, profile: Profile) -> str | None:
    for what, needed in (("flash", count.flash_bytes), ("RAM", count.ram_bytes)):
        has_kib = profile.value(f"{what.lower()}_kib")
        if has_kib is not None and needed > has_kib * _KIB:
            return f"does not fit: needs {needed / _KIB:.1f} KB of {what}, the part has {has_kib:g}"
    return None


def _whole(size_bytes: int) -> str:
    return f"{size_bytes / _KIB:.3g}"


def _of(size_kib: float | None) -> str:
    return f"{size_kib:g} KB" if size_kib is not None else "any"
