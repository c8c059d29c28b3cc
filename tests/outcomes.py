"""Digest what the public commands give, to compare two checkouts bit for bit.

    python tests/outcomes.py path/to/bench FOLDER > digests.json

Ten blind cases, two waveform cases, and every model on every backend on 600 simulated rows. Run it
with the `bench` of each checkout and compare the two outputs: what names code, time or machine is
left out, everything else is hashed to the last bit.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path

PASSING = {"code_hash", "versions", "created_utc", "host", "fit_s", "digest", "opener", "artifact"}
PASSING |= {"estimates", "schema_version", "data"}  # data: the path of the table
PASSING |= {"model_target", "backend_target", "declared", "threads", "cost", "training", "floor"}
PASSING |= {"seconds", "content_sha256", "artifacts_sha256", "predictions_sha256"}


def without(value: object) -> object:
    """Return a record without what names code, time or machine."""
    if isinstance(value, dict):
        doubled = {"simulated"} if "data_fingerprint" in value else set()  # a key repeats it
        passing = PASSING | doubled
        return {k: without(v) for k, v in sorted(value.items()) if k not in passing}
    return [without(v) for v in value] if isinstance(value, list) else value


def digest(value: object) -> str:
    """Return 16 hex digits of a JSON value."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


def table(path: Path) -> None:
    """Write 600 rows in 30 links over three rooms with CIRs, from numpy alone."""
    import numpy as np
    import pandas as pd

    rng = np.random.default_rng(5)
    links = np.repeat(np.arange(30), 20)
    error = rng.gamma(1.5, 0.08, 30)[links] + rng.normal(0, 0.03, 600)
    time = np.arange(160)
    first = np.exp(-0.5 * ((time - 8) / 1.2) ** 2)
    late = np.exp(-(time - 8) / 25) * (time > 8)
    cirs = 3000 * first + (6000 * error[:, None]) * late * rng.rayleigh(1, (600, 160))
    cirs = np.abs(cirs + rng.normal(0, 40, (600, 160))).astype(np.float32)
    frame = pd.DataFrame({"true_range_m": rng.uniform(2, 12, 30)[links], "error_m": error})
    frame["range_m"] = frame["true_range_m"] + frame["error_m"]
    frame["cir"] = list(cirs)
    frame["first_path_index"], frame["link"] = 7.5, [f"l{k}" for k in links]
    frame["environment"] = np.array(["a", "b", "c"])[links % 3]
    frame["los"] = links % 4 == 0
    frame.to_parquet(path)


def main(bench: str, folder: Path) -> None:
    """Run the commands and print their digests."""
    folder.mkdir(parents=True, exist_ok=True)
    table(folder / "small.parquet")
    run = [bench, "run", "--model", "remnet,cnn1d,svm,mlp,none", "--backend", "all", "--split"]
    run += ["link-kfold:3", "--data", str(folder / "small.parquet"), "--out", str(folder / "runs")]
    subprocess.run(run, check=True, stdout=sys.stderr)
    blind = [bench, "challenge", "--cases", "12", "--seed", "2"]
    subprocess.run([*blind, "-o", str(folder / "blind")], check=True, stdout=sys.stderr)
    found = {}
    for path in sorted((folder / "blind" / "cases").glob("*.json")):
        found[f"case {path.stem}"] = digest(without(json.loads(path.read_text())))
    for path in sorted((folder / "runs").rglob("*.json")):
        content = json.loads(path.read_text())
        if content.get("kind") == "run":
            key = content["key"]
            found[f"{key['model']} {key['backend']}"] = digest(without(content))
    print(json.dumps(found, indent=1, sort_keys=True))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
