"""Simulator files: the default one or a small one, edited line by line."""

from __future__ import annotations

import random
from pathlib import Path

from tests.fuzz.hostile import CODES, TEXTS, damaged, file_name, odd_file, text

ROOMS = Path(__file__).parents[2] / "bench" / "physics" / "rooms.toml"
SMALL = """name = "small"
seed = 3

[base]
channel = 2
prf_mhz = 64
preamble_symbols = 1024

[[effects]]
effect = "antenna-delay"
delay_ns = 0.5

[[effects]]
effect = "timestamp-jitter"
jitter_samples = 0.1
"""
EFFECTS = ("antenna-delay", "power-bias", "clock-offset", "temperature-drift", "noise-floor")
EFFECTS += ("material-delay", "late-detection", "diffraction", "ground-bounce", "diffuse-tail")
EFFECTS += ("path-loss", "quantisation", "device-clock", "power-curve", "unnamed", "level-control")
VALUES = (*CODES, "-1", "0", "1e300", "true", '"text"', "[1, 2]", "[]", "{a = 1}", "1979-05-27")
VALUES += ("-1e-9", "0x7f", '"\\u001b[31m"', "'''\na\n'''", "")


def simulator_file(rng: random.Random, folder: Path) -> tuple[Path, str]:
    """Write a simulator, honest, edited or none; return its path and what it is."""
    folder = folder / "simulators"
    folder.mkdir(exist_ok=True)
    path = folder / file_name(rng, ".toml")
    if rng.random() < 0.1:
        return path, "simulator " + odd_file(rng, path)
    lines = (ROOMS.read_text() if rng.random() < 0.2 else SMALL).splitlines()
    edits = rng.choice((0, 1, 1, 2, 3))
    for _ in range(edits):
        _edit(rng, lines)
    content = "\n".join(lines).encode(errors="replace")
    if rng.random() < 0.06:
        content = damaged(rng, content)
    path.write_bytes(content)
    return path, f"simulator with {edits} edits"


def _edit(rng: random.Random, lines: list[str]) -> None:
    at = rng.randrange(len(lines)) if lines else 0
    match rng.randrange(7):
        case 0 | 1 | 2:
            keyed = [i for i, line in enumerate(lines) if "=" in line]
            if keyed:
                row = rng.choice(keyed)
                lines[row] = f"{lines[row].partition('=')[0]}= {rng.choice(VALUES)}"
        case 3:
            del lines[at : at + 1]
        case 4:
            lines.insert(at, lines[at] if lines else "")
        case 5:
            lines += ["", "[[effects]]", f'effect = "{rng.choice((*EFFECTS, "nobody"))}"']
            if rng.random() < 0.6:
                lines.append(f"{_key(rng)} = {rng.choice(VALUES)}")
        case 6:
            lines.insert(at, f"{_key(rng)} = {rng.choice(VALUES)}")


def _key(rng: random.Random) -> str:
    known = ("delay_ns", "jitter_samples", "slope_m", "seed", "name", "base", "effects", "symbols")
    if rng.random() < 0.5:
        return rng.choice(known)
    return '"' + text(rng).translate({34: None, 92: None, 10: None, 0: None}) + '"'


NAMES = ("rooms", "room", *TEXTS[:6])
