"""`bench devices`: the device profiles, and what every figure in them rests on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

import click

from bench.cli.console import print_json, print_table, say
from bench.errors import BenchError
from bench.measure.on_devices import load_device
from bench.measure.profile import Coefficient, Profile
from bench.plugins import Plugin, find, plugins

NOTE = (
    "Figures of devices are ESTIMATES. bench devices NAME shows every coefficient and its source."
)


@click.command(epilog="Example: bench devices cortex-a53")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
def command(name: str | None, as_json: bool) -> None:
    """List the device profiles, or show every coefficient of one with unit and source."""
    if name is not None:
        _show_one(load_device(find("devices", name)), as_json)
    elif as_json:
        print_json([_facts(plugin) for plugin in plugins("devices")])
    else:
        columns = ("name", "device", "clock, energy, memory", "figures")
        print_table("Device profiles", columns, [_row(plugin) for plugin in plugins("devices")])
        say(NOTE)


def _row(plugin: Plugin) -> tuple[str, ...]:
    try:
        profile = load_device(plugin)
    except BenchError as problem:
        return (plugin.name, _reason(problem), "", "")
    kinds = Counter(entry.kind for entry in profile.coefficients.values())
    return (
        plugin.name,
        f"{profile.title}; runs {', '.join(profile.precisions)}",
        "\n".join(
            [f"{profile.value('frequency_mhz') or 0:.4g} MHz", *_energy(profile), *_memory(profile)]
        ),
        "\n".join(f"{count} {kind}" for kind, count in kinds.most_common()),
    )


def _reason(problem: BenchError) -> str:
    return str(problem).partition(" is ")[2]


def _energy(profile: Profile) -> Iterator[str]:
    """Yield the energy of a cycle, or the power, as a range where precisions differ."""
    if (cycle_pj := profile.value("cycle_energy_pj")) is not None:
        yield f"{cycle_pj:g} pJ/cycle"
    entries = profile.coefficients.items()
    watts = sorted({entry.value for name, entry in entries if name.startswith("power_w")})
    if watts:
        yield " to ".join(f"{one:g}" for one in dict.fromkeys((watts[0], watts[-1]))) + " W"


def _memory(profile: Profile) -> Iterator[str]:
    for what in ("flash", "ram"):
        if (size_kib := profile.value(f"{what}_kib")) is not None:
            yield f"{size_kib:g} KiB {'RAM' if what == 'ram' else what}"


def _facts(plugin: Plugin) -> dict[str, Any]:
    try:
        return {**asdict(plugin), "problem": None, "profile": asdict(load_device(plugin))}
    except BenchError as problem:
        return {**asdict(plugin), "problem": _reason(problem), "profile": None}


def _show_one(profile: Profile, as_json: bool) -> None:
    if as_json:
        print_json(asdict(profile))
        return
    say(f"{profile.name}: {profile.title}")
    say(f"runs {', '.join(profile.precisions)}")
    for line in _lines(profile.coefficients):
        say(line)
    for mode, entries in profile.modes.items():
        say(f"in mode {mode!r} instead:")
        for line in _lines(entries):
            say(line)


def _lines(entries: Mapping[str, Coefficient]) -> Iterator[str]:
    for name, one in entries.items():
        span = "" if one.low == one.high else f" ({one.low:g} to {one.high:g})"
        yield f"  {name} = {one.value:g}{span} {one.unit}"
        yield f"      {one.kind}: {one.source}"
