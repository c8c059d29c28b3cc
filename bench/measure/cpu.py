"""What the processor is called and which instruction sets it has, on Linux, macOS and Windows."""

from __future__ import annotations

import platform
import subprocess
import sys
from pathlib import Path

CPUINFO = Path("/proc/cpuinfo")
SSE, AVX, INTEGER_DOT, ARM = (
    ("sse4_2",),
    ("avx", "avx2", "fma", "avx512f"),
    ("avx512_vnni", "avx_vnni", "amx_int8", "asimddp", "i8mm"),
    ("asimd",),
)
INSTRUCTION_SETS = (*SSE, *AVX, *ARM, *INTEGER_DOT)
"""Those that decide how fast a network runs, by their Linux names; 8-bit dot products last."""

_MAC_NAMES = {
    "hw.optional.sse4_2": "sse4_2",
    "hw.optional.avx1_0": "avx",
    "hw.optional.avx2_0": "avx2",
    "hw.optional.fma": "fma",
    "hw.optional.avx512f": "avx512f",
    "hw.optional.avx512vnni": "avx512_vnni",
    "hw.optional.neon": "asimd",
    "hw.optional.arm.FEAT_DotProd": "asimddp",
    "hw.optional.arm.FEAT_I8MM": "i8mm",
}
# winnt.h, PF_..._AVAILABLE: Windows tells of no other set in the list.
_WINDOWS_NUMBERS = {38: "sse4_2", 39: "avx", 40: "avx2", 41: "avx512f", 19: "asimd", 43: "asimddp"}


def processor() -> tuple[str, list[str]]:
    """Return the processor's name and those of `INSTRUCTION_SETS` it is known to have."""
    name, flags = _read()
    return name or platform.processor() or "unknown", [s for s in INSTRUCTION_SETS if s in flags]


def _read() -> tuple[str, set[str]]:
    if CPUINFO.exists():
        return from_cpuinfo(CPUINFO.read_text(encoding="utf-8", errors="replace"))
    if sys.platform == "darwin":
        return from_sysctl(_sysctl())
    if sys.platform == "win32":
        return _from_windows()
    return "", set()


def from_cpuinfo(text: str) -> tuple[str, set[str]]:
    """Return name and flags from Linux's /proc/cpuinfo; small boards give their model instead."""
    entries: dict[str, str] = {}
    for line in text.splitlines():
        key, _, value = line.partition(":")
        entries.setdefault(key.strip(), value.strip())
    name = entries.get("model name") or entries.get("Model") or entries.get("Hardware") or ""
    return name, set((entries.get("flags") or entries.get("Features") or "").split())


def from_sysctl(text: str) -> tuple[str, set[str]]:
    """Return name and flags from the output of macOS's `sysctl machdep.cpu hw.optional`."""
    entries = dict(line.split(": ", 1) for line in text.splitlines() if ": " in line)
    flags = {flag for key, flag in _MAC_NAMES.items() if entries.get(key, "0").strip() == "1"}
    return entries.get("machdep.cpu.brand_string", ""), flags


def _sysctl() -> str:
    command = ["/usr/sbin/sysctl", "machdep.cpu.brand_string", "hw.optional"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=5, check=False)  # noqa: S603 - fixed command
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout


def _from_windows() -> tuple[str, set[str]]:
    if sys.platform != "win32":
        return "", set()
    import ctypes
    import winreg

    has = ctypes.windll.kernel32.IsProcessorFeaturePresent
    flags = {flag for number, flag in _WINDOWS_NUMBERS.items() if has(number)}
    where = r"HARDWARE\DESCRIPTION\System\CentralProcessor\0"
    with winreg.OpenKey(winreg.HKEY_LOCAL_MACHINE, where) as key:
        return str(winreg.QueryValueEx(key, "ProcessorNameString")[0]).strip(), flags
