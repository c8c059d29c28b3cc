"""`bench models`, `backends`, `devices`: what is listed, what is imported, what is broken."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner, Result

from bench.cli.main import group
from bench.errors import BenchError
from bench.plugins import OUR_DISTRIBUTION, Plugin

HEAVY = ("torch", "onnxruntime", "sklearn", "matplotlib", "pandas", "pyarrow", "numba", "scipy")
PROBE = f"""
import sys
sys.argv = ["bench", *sys.argv[1:]]
from bench.cli.main import main
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
print("LOADED", *sorted(set({HEAVY!r}) & set(sys.modules)))
"""
BROKEN = Plugin("models", "broken", "no_such_package:Model", "their-package")


def _run(*arguments: str) -> Result:
    return CliRunner().invoke(group, arguments)


@pytest.fixture
def with_broken(monkeypatch: pytest.MonkeyPatch):
    """Register a plug-in that cannot be imported in every group."""
    from bench.cli import devices, listing

    def patched(module: object) -> None:
        real = module.plugins

        def broken(name: str) -> list[Plugin]:
            return [*real(name), Plugin(name, BROKEN.name, BROKEN.target, "theirs")]

        monkeypatch.setattr(module, "plugins", broken)

    patched(listing)
    patched(devices)


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["models"], ["models", "--json"], ["backends"], ["devices"], ["effects"]],
)
def test_listing_imports_nothing_heavy(arguments) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROBE, *arguments], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].split() == ["LOADED"]


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("models", {"none", "remnet", "cnn1d", "svm", "mlp"}),
        ("backends", {"fp32", "graph", "fp16", "int8", "qat", "c-fp32", "c-int8", "c-qat"}),
    ],
)
def test_built_ins_are_listed_with_a_summary(kind, names) -> None:
    ours = [
        one
        for one in json.loads(_run(kind, "--json").output)
        if one["distribution"] == OUR_DISTRIBUTION
    ]
    assert {one["name"] for one in ours} >= names
    assert all(len(one["summary"]) > 10 for one in ours)
    assert all(one["problem"] is None for one in ours)
    shown = _run(kind).output
    assert all(name in shown for name in names)


@pytest.mark.parametrize("kind", ["models", "backends", "devices"])
def test_a_broken_plug_in_is_one_line_and_changes_no_other(kind, with_broken) -> None:
    listed = json.loads(_run(kind, "--json").output)
    broken = listed[-1]
    assert broken["name"] == "broken"
    assert broken["problem"].startswith("unavailable: ModuleNotFoundError")
    assert all(one["problem"] is None for one in listed[:-1])
    shown = _run(kind)
    assert shown.exit_code == 0
    assert "unavailable:" in shown.output


def test_devices_show_clock_energy_memory_and_how_sure_they_are() -> None:
    shown = _run("devices").output
    for text in ("cortex-a53", "nrf52832", "64 MHz", "174 pJ/cycle", "512 KiB flash", "0.7 W"):
        assert text in shown
    assert "ESTIMATES" in shown


def test_devices_as_json_hold_the_whole_profile() -> None:
    listed = {one["name"]: one for one in json.loads(_run("devices", "--json").output)}
    entry = listed["nrf52832"]["profile"]["coefficients"]["flash_kib"]
    assert (entry["value"], entry["unit"], entry["kind"]) == (512, "KiB", "datasheet")


def test_one_device_shows_every_coefficient_with_unit_source_and_kind() -> None:
    shown = _run("devices", "cortex-a57").output
    profile = json.loads(_run("devices", "cortex-a57", "--json").output)
    for name, entry in profile["coefficients"].items():
        assert name in shown
        assert f"{entry['kind']}: {entry['source']}" in shown
    assert "in mode '5w' instead:" in shown
    assert "918 MHz" in shown


def test_an_unknown_device_gets_a_did_you_mean() -> None:
    with pytest.raises(BenchError, match="did you mean 'cortex-a53'"):
        raise _run("devices", "cortexa53").exception


def test_a_device_that_is_no_profile_is_unavailable(monkeypatch) -> None:
    from bench.cli import devices

    odd = Plugin("devices", "odd", "json:dumps", "theirs")
    monkeypatch.setattr(devices, "plugins", lambda group: [odd])
    monkeypatch.setattr(devices, "find", lambda group, name: odd)
    [listed] = json.loads(_run("devices", "--json").output)
    assert listed["problem"] == "unavailable: a Profile was expected, not function"
    with pytest.raises(BenchError, match="a Profile was expected"):
        raise _run("devices", "odd").exception


def test_an_effect_says_what_it_is_and_stands_on() -> None:
    """A user who read `level-control` in a verdict found no page that defines it."""
    text = _run("effects", "level-control").output
    for said in ("recognised by", "source: DW1000", "needs columns: preamble_count", "peak_counts"):
        assert said in text
    facts = json.loads(_run("effects", "antenna-delay", "--json").output)
    assert facts["acts_on"] == "ranging"
    assert {"name", "unit", "low", "high", "meaning"} <= set(facts["parameters"][0])
    wrong = _run("effects", "level-contrl")
    assert isinstance(wrong.exception, BenchError)
    assert "level-control" in str(wrong.exception)


def test_every_effect_can_be_shown() -> None:
    for one in json.loads(_run("effects", "--json").output):
        facts = json.loads(_run("effects", one["name"], "--json").output)
        assert facts["words"]
        assert facts["source"]
