"""What the outcome of a diagnosis depends on, so that a stopped one resumes only as itself."""

from __future__ import annotations

from dataclasses import asdict

from bench.discrepancy.method import Options
from bench.physics.simulator import Simulator
from bench.physics.toml_file import to_toml
from bench.plugins import plugins
from bench.provenance import (
    decisive_versions,
    json_digest,
    packages_code_hash,
    plugins_code_hash,
)
from bench.recordings.table import Recordings

CODE = ("bench/discrepancy", "bench/physics", "bench/recordings")


def fingerprint(recorded: Recordings, simulated: Simulator | Recordings, options: Options) -> str:
    """Return 16 hex digits of code, packages, effects, both sides' content, options and seed."""
    other = simulated.fingerprint if isinstance(simulated, Recordings) else to_toml(simulated)
    parts = {
        "code": packages_code_hash(*CODE),
        "effects": plugins_code_hash(plugins("effects")),
        "versions": decisive_versions(),
        "recorded": [recorded.fingerprint, recorded.simulator],
        "simulated": other,
        "options": asdict(options),
    }
    return json_digest(parts, 16)
