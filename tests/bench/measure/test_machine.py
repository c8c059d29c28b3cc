"""The machine's description on three systems, and that it names nobody."""

from __future__ import annotations

import json
import os
import platform

import pytest

from bench.measure import cpu, machine
from bench.measure.machine import describe_machine


@pytest.fixture
def fresh():
    """Describe the machine anew, before and after."""
    machine._described.cache_clear()
    yield
    machine._described.cache_clear()


def test_description_is_json_and_the_id_is_stable(fresh) -> None:
    first = describe_machine()
    machine._described.cache_clear()
    assert describe_machine() == first
    assert json.loads(json.dumps(first)) == first
    assert len(first["id"]) == 12
    assert first["cores"] == os.cpu_count()
    assert first["python"] == platform.python_version()
    assert first["versions"]["numpy"]
    assert first["memory_gib"] > 0


def test_nobody_is_named(fresh) -> None:
    told = {"cpu", "cores", "instruction_sets", "system", "python", "versions", "memory_gib", "id"}
    assert set(describe_machine()) == told
    assert describe_machine()["system"] == f"{platform.system()} {platform.machine()}"


def test_another_runtime_or_processor_is_another_machine(fresh, monkeypatch) -> None:
    before = describe_machine()["id"]
    monkeypatch.setattr(machine, "version", lambda package: "99.0")
    machine._described.cache_clear()
    other_runtime = describe_machine()["id"]
    monkeypatch.setattr(machine, "processor", lambda: ("abacus", []))
    machine._described.cache_clear()
    assert len({before, other_runtime, describe_machine()["id"]}) == 3


def test_a_runtime_that_is_not_installed_is_absent(fresh, monkeypatch) -> None:
    monkeypatch.setattr(machine, "RUNTIME_PACKAGES", ("no-such-runtime",))
    assert describe_machine()["versions"] == {"no-such-runtime": "absent"}


INTEL = """processor\t: 0
vendor_id\t: GenuineIntel
model name\t: Intel(R) Xeon(R) Processor @ 2.50GHz
flags\t\t: fpu sse4_2 avx avx2 fma avx512f avx512_vnni
processor\t: 1
model name\t: Another
"""
RASPBERRY = """processor\t: 0
Features\t: fp asimd evtstrm crc32 cpuid
CPU part\t: 0xd03

Hardware\t: BCM2835
Model\t\t: Raspberry Pi 3 Model B Plus Rev 1.3
"""
MAC = """machdep.cpu.brand_string: Apple M2
hw.optional.neon: 1
hw.optional.arm.FEAT_DotProd: 1
hw.optional.arm.FEAT_I8MM: 1
hw.optional.avx2_0: 0
"""


@pytest.mark.parametrize(
    ("text", "name", "has"),
    [
        (INTEL, "Intel(R) Xeon(R) Processor @ 2.50GHz", "avx512_vnni"),
        (RASPBERRY, "Raspberry Pi 3 Model B Plus Rev 1.3", "asimd"),
    ],
)
def test_linux(text, name, has, tmp_path, monkeypatch) -> None:
    (tmp_path / "cpuinfo").write_text(text)
    monkeypatch.setattr(cpu, "CPUINFO", tmp_path / "cpuinfo")
    found, sets = cpu.processor()
    assert found == name
    assert has in sets
    assert set(sets) <= set(cpu.INSTRUCTION_SETS)


def test_macos(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(cpu, "CPUINFO", tmp_path / "absent")
    monkeypatch.setattr(cpu.sys, "platform", "darwin")
    monkeypatch.setattr(cpu, "_sysctl", lambda: MAC)
    assert cpu.processor() == ("Apple M2", ["asimd", "asimddp", "i8mm"])


def test_a_system_that_tells_nothing(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(cpu, "CPUINFO", tmp_path / "absent")
    monkeypatch.setattr(cpu.sys, "platform", "plan9")
    monkeypatch.setattr(cpu.platform, "processor", lambda: "")
    assert cpu.processor() == ("unknown", [])


def test_sysctl_that_is_missing_is_no_error(monkeypatch) -> None:
    def missing(*_: object, **__: object) -> None:
        raise FileNotFoundError

    monkeypatch.setattr(cpu.subprocess, "run", missing)
    assert cpu._sysctl() == ""
