"""Cases: a command line with everything it names put into a folder."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from tests.fuzz.hostile import COUNTS, argument, odd_output
from tests.fuzz.plugins import plugin_package
from tests.fuzz.results import result_folder
from tests.fuzz.simulators import NAMES, simulator_file
from tests.fuzz.tables import table_file

Stdout = Literal["file", "full", "closed"]
COLUMNS = ("error_m", "link", "los", "cir", "time_s", "nothing", ",", "", "error_m,error_m")


@dataclass
class Case:
    """One command to run in `folder`; `site` holds plug-ins, `about` says what is hostile."""

    words: list[str]
    about: str
    site: Path | None = None
    stdout: Stdout = "file"
    outputs: list[Path] = field(default_factory=list)


def make_case(rng: random.Random, folder: Path) -> Case:
    """Return a case; everything it needs is in `folder`."""
    maker = rng.choices([kind for kind, _ in _KINDS], [weight for _, weight in _KINDS])[0]
    case = maker(rng, folder)
    if rng.random() < 0.03:
        case.stdout = rng.choice(("full", "closed"))
    return case


def _maybe(rng: random.Random, words: list[str], share: float = 0.4) -> list[str]:
    return words if rng.random() < share else []


def _import(rng: random.Random, folder: Path) -> Case:
    table, about = table_file(rng, folder)
    out = odd_output(rng, folder, rng.choice((".parquet", ".parquet", ".parquet", ".csv")))
    return Case(["data", "import", str(table), "-o", str(out)], about, outputs=[out])


def _info(rng: random.Random, folder: Path) -> Case:
    table, about = table_file(rng, folder)
    picture = odd_output(rng, folder, rng.choice((".png", ".svg", ".pdf", ".doc")))
    drawn = rng.random() < 0.1
    words = ["data", "info", str(table), *_maybe(rng, ["--json"])]
    plot = ["--plot", str(picture)] if drawn else []
    return Case([*words, *plot], about, outputs=[picture] if drawn else [])


def _run(rng: random.Random, folder: Path) -> Case:
    table, about = table_file(rng, folder)
    out = folder / "runs" if rng.random() < 0.8 else odd_output(rng, folder, "")
    words = ["run", "--model", rng.choice(("none", "none", "none", "none,none", "nobody"))]
    words += ["--backend", rng.choice(("fp32", "fp32", "int8", argument(rng)))]
    words += ["--data", str(table), "--out", str(out), *_maybe(rng, ["--json"])]
    splits = ("link-kfold:2", "link-kfold:2", "link-kfold:99", "leave-environment-out", "link")
    words += _maybe(rng, ["--split", rng.choice((*splits, argument(rng)))], 0.7)
    words += _maybe(rng, ["--seeds", rng.choice(COUNTS)], 0.1)
    words += _maybe(rng, ["--device", rng.choice(("host", "", ",", argument(rng)))], 0.2)
    return Case(words, about, outputs=[out])


def _simulate(rng: random.Random, folder: Path) -> Case:
    simulator, about = simulator_file(rng, folder)
    named = str(simulator) if rng.random() < 0.85 else rng.choice(NAMES).replace("\x00", "") or "r"
    out = odd_output(rng, folder, rng.choice((".parquet", ".parquet", ".csv", "")))
    words = ["simulate", named, "-o", str(out), *_maybe(rng, ["--json"])]
    if rng.random() < 0.5:
        table, more = table_file(rng, folder)
        words, about = [*words, "--geometry", str(table)], f"{about}, {more}"
    else:
        words += ["--rooms", "-n", rng.choice(("5", "20", "40", *COUNTS[:3], *COUNTS[5:]))]
    words += _maybe(rng, ["--seed", rng.choice(COUNTS)], 0.2)
    return Case(words, about, outputs=[out])


def _diagnose(rng: random.Random, folder: Path) -> Case:
    table, about = table_file(rng, folder)
    words = ["diagnose", "--recorded", str(table), "--paths-only", "--seed", "0"]
    words += _maybe(rng, ["--json"])
    words += _maybe(rng, ["--observe", rng.choice(COLUMNS)], 0.7)
    words += _maybe(rng, ["--hide", rng.choice((*COLUMNS, argument(rng)))], 0.3)
    words += _maybe(rng, ["--environment", rng.choice(("a", argument(rng)))], 0.3)
    if rng.random() < 0.6:
        simulator, more = simulator_file(rng, folder)
        words, about = [*words, "--simulated", str(simulator)], f"{about}, {more}"
    elif rng.random() < 0.5:
        (folder / "other").mkdir()
        other, more = table_file(rng, folder / "other")
        words, about = [*words, "--simulated", str(other)], f"{about}, against {more}"
    outputs = [odd_output(rng, folder, "")] if rng.random() < 0.3 else []
    return Case([*words, *(w for out in outputs for w in ("-o", str(out)))], about, outputs=outputs)


def _leaderboard(rng: random.Random, folder: Path) -> Case:
    results, about = result_folder(rng, folder)
    words, outputs = ["leaderboard", "--results", str(results), *_maybe(rng, ["--json"])], []
    if rng.random() < 0.4:
        outputs = [odd_output(rng, folder, ".md")]
        words += ["--out", str(outputs[0])]
    if rng.random() < 0.06:
        outputs.append(odd_output(rng, folder, rng.choice((".svg", ".png", ".gif"))))
        words += ["--plot", str(outputs[-1])]
    words += _maybe(rng, ["--machine", rng.choice(("Example", argument(rng)))], 0.2)
    words += _maybe(rng, ["--device", argument(rng)], 0.1)
    return Case(words, about, outputs=outputs)


def _plugin(rng: random.Random, folder: Path) -> Case:
    site, group, about = plugin_package(rng, folder)
    if group in ("models", "backends") and rng.random() < 0.5:
        table, _ = _honest_table(rng, folder)
        model, backend = ("evil", "fp32") if group == "models" else ("none", "evil")
        words = ["run", "--model", model, "--backend", backend, "--data", str(table)]
        words += [
            "--split",
            "link-kfold:2",
            "--out",
            str(folder / "runs"),
            *_maybe(rng, ["--json"]),
        ]
        return Case(words, about, site, outputs=[folder / "runs"])
    listing = {"datasets": ["data", "list"], "effects": ["doctor"], "simulators": ["doctor"]}
    words = rng.choice((listing.get(group, [group]), ["doctor"], *_uses(group, folder)))
    return Case([*words, *_maybe(rng, ["--json"])], about, site)


def _uses(group: str, folder: Path) -> list[list[str]]:
    """Return commands that use the plug-in `evil` of a group."""
    toml = folder / "evil.toml"
    toml.write_text('[[effects]]\neffect = "evil"\n')
    out = ["--rooms", "-n", "5", "-o", str(folder / "simulated.parquet")]
    return {
        "devices": [["devices", "evil"]],
        "datasets": [["data", "info", "evil"]],
        "effects": [["simulate", str(toml), *out]],
        "simulators": [["simulate", "evil", *out]],
    }.get(group, [])


def _honest_table(rng: random.Random, folder: Path) -> tuple[Path, str]:
    from tests.fuzz.tables import honest

    path = folder / "honest.parquet"
    honest(rng).to_parquet(path)
    return path, "honest"


def _options(rng: random.Random, folder: Path) -> Case:
    odd, number = argument(rng), rng.choice(COUNTS)
    words = rng.choice(
        (
            ["devices", odd],
            ["models", odd],
            ["doctor", "--json"],
            [odd],
            [],
            ["data", odd],
            ["data", "info", odd],
            ["data", "fetch", odd],
            ["plugin", "new", odd, "-o", str(folder)],
            ["plugin", "new", "mine", "--kind", rng.choice(("model", "dataset")), "-o", odd or "x"],
            ["challenge", "--cases", rng.choice(("0", "-1", "abc", "1.5")), "-o", str(folder)],
            ["challenge", "--case", odd, "-o", str(folder)],
            ["reproduce", odd, "--out", str(folder / "out")],
            ["reproduce", "--list"],
            ["reproduce", "optimisation", "--jobs", number, "--data", odd],
            ["run", "--model", odd, "--backend", odd, "--out", str(folder / "out")],
            ["run", "--model", "none", "--backend", "fp32", "--data", odd, "--seeds", number],
            ["diagnose", "--recorded", odd, "--seed", number],
            ["simulate", "rooms", "--rooms", "-n", "5", "-o", odd, "--seed", number],
        )
    )
    return Case([*words, *_maybe(rng, ["--json"], 0.2)], "options")


def _reproduce(rng: random.Random, folder: Path) -> Case:
    table, about = table_file(rng, folder)
    names = rng.choice(("pca", "residuals", "cir-size", "rooms", "all,", "pca,nobody"))
    out = odd_output(rng, folder, "")
    words = ["reproduce", names, "--data", str(table), "--out", str(out), "--quick"]
    if "honest" in about:  # it would train for minutes: leave it without its data
        words[3] = str(folder / "absent.parquet")
    return Case([*words, *_maybe(rng, ["--json"])], about, outputs=[out])


_KINDS: tuple[tuple[Callable[[random.Random, Path], Case], int], ...] = (
    (_import, 16),
    (_info, 16),
    (_run, 12),
    (_simulate, 16),
    (_diagnose, 7),
    (_leaderboard, 18),
    (_plugin, 16),
    (_options, 14),
    (_reproduce, 3),
)
