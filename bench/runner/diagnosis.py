"""What the outcome of a diagnosis depends on, so that a stopped one resumes only as itself."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict

from bench.discrepancy.method import Options
from bench.physics.simulator import Simulator
from bench.physics.toml_file import to_toml
from bench.plugins import plugins
from bench.provenance import decisive_versions, effects_code_hash, packages_code_hash
from bench.recordings.table import Recordings

CODE = ("bench/discrepancy", "bench/physics", "bench/recordings")


def fingerprint(recorded: Recordings, simulated: Simulator | Recordings, options: Options) -> str:
    """Return 16 hex digits of code, packages, effects, both sides' content, options and seed."""
    other = simulated.fingerprint if isinstance(simulated, Recordings) else to_toml(simulated)
    parts = {
        "code": packages_code_hash(*CODE),
        "effects": sorted(f"{plugin.name}={plugin.target}" for plugin in plugins("effects")),
        "effects_code": effects_code_hash(plugins("effects")),
        "versions": decisive_versions(),
        "recorded": recorded.fingerprint,
        "simulated": other,
        "options": asdict(options),
    }
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16]
