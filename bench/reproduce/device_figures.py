"""Figures of one run on device profiles: ESTIMATES, with the low and high of the coefficients."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bench.errors import BenchError
from bench.measure.profile import Profile
from bench.plugins import find, plugins
from bench.reproduce.outcome import Series
from bench.reproduce.paper_devices import mode_name
from bench.results import Interval

US_PER_MS = 1000.0
HOST = "host"
RANGE = (
    "Brackets beside an estimate: low to high of the profile's coefficients, not a confidence "
    "interval."
)


def device_profiles() -> Iterator[tuple[str, Profile]]:
    """Yield every device profile that loads, by name, each mode of it after it."""
    for plugin in plugins("devices"):
        if plugin.problem() is not None:
            continue
        profile = plugin.load()
        if isinstance(profile, Profile):
            yield plugin.name, profile
            for mode in profile.modes:
                yield mode_name(plugin.name, mode), profile.in_mode(mode)


def chosen_devices(names: str) -> list[str]:
    """Return the names of a comma-separated list of devices.

    Raises BenchError (with a did-you-mean) for a name that is no device, and for an empty list.
    """
    wanted = [name.strip() for name in names.split(",") if name.strip()]
    if not wanted:
        raise BenchError("--device names no device: expected a name, or several with commas")
    return [find("devices", name).name for name in dict.fromkeys(wanted)]


def in_ms(figure: Interval) -> Interval:
    """Return microseconds as milliseconds."""
    low, high = ends_of(figure)
    return Interval(figure.value / US_PER_MS, low / US_PER_MS, high / US_PER_MS)


def ends_of(figure: Interval) -> tuple[float, float]:
    """Return low and high, the value itself where an end is not known."""
    low = figure.value if figure.low is None else figure.low
    return low, figure.value if figure.high is None else figure.high


def point(x: Interval, y: Interval, colour: str, marker: str, hollow: bool = False) -> Series:
    """Return one point of a trade-off picture with both its intervals."""
    (x_low, x_high), (low, high) = ends_of(x), ends_of(y)
    return Series(
        f"{colour}, {marker}", [x.value], [y.value], low=[low], high=[high], x_low=[x_low],
        x_high=[x_high], colour=colour, marker=marker, style="hollow" if hollow else "",
    )  # fmt: skip


def extent(points: Sequence[Series]) -> tuple[float, float]:
    """Return the smallest and the largest x."""
    values = [float(one.x[0]) for one in points]
    return min(values), max(values)
