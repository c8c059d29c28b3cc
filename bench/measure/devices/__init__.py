"""The device profiles that come with the project, one TOML file each.

`bench.measure.devices:cortex_a53` is the profile in `cortex-a53.toml`, read when it is asked for;
`host` is this machine, with its own clock where the system tells it.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from bench.measure.profile import Coefficient, Profile, load_profile


def __getattr__(name: str) -> Profile:
    path = Path(__file__).parent / f"{name.replace('_', '-')}.toml"
    if not path.is_file():
        raise AttributeError(f"module {__name__!r} has no profile {name!r}")
    profile = load_profile(path)
    return _with_own_clock(profile) if name == "host" else profile


def _with_own_clock(profile: Profile) -> Profile:
    """Return the profile with this machine's clock in place of the file's."""
    import psutil

    clock = psutil.cpu_freq()
    if clock is None or not clock.current:
        return profile
    highest = float(max(clock.max or 0.0, clock.current))
    entry = Coefficient(highest, float(clock.current), highest, "MHz", "this system", "measured")
    return replace(profile, coefficients={**profile.coefficients, "frequency_mhz": entry})
