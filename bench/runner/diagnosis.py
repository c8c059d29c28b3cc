"""`bench.diagnose`: what a simulator leaves out of recordings, as one Python call."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

import pandas as pd

from bench.checkpoint.journal import Kept
from bench.discrepancy import Diagnosis, Options, method, write_report
from bench.discrepancy.data.truth import check_hidden
from bench.errors import BenchError
from bench.files import check_output
from bench.parallel import Spread, one_blas_thread, spreading
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.physics.simulators import read_simulator
from bench.physics.toml_file import to_toml
from bench.plugins import plugins
from bench.provenance import (
    decisive_versions,
    json_digest,
    packages_code_hash,
    plugins_code_hash,
)
from bench.recordings.io import CSV_SUFFIXES, PARQUET_SUFFIXES
from bench.recordings.open import Table, read
from bench.recordings.table import Recordings
from bench.runner.diagnosis_inputs import write_inputs
from bench.runner.observer import Observer

PARTS = ("diagnosis.json", "report.md", "simulator.toml", "inputs.json", "evidence.parquet",
         *(f"{one}.png" for one in ("residual", "ladder", "ranks", "profile")))  # fmt: skip
CODE = ("bench/discrepancy", "bench/physics", "bench/recordings")


def diagnose(
    recorded: Table,
    simulated: Table | Simulator | None = None,
    *,
    hide: str | Iterable[str] = (),
    measured: str | Iterable[str] = (),
    known: str | Iterable[str] = (),
    observe: str | Iterable[str] = (),
    environment: str | None = None,
    paths_only: bool = False,
    seed: int = 0,
    out: str | Path | None = None,
    jobs: int = 1,
    scheduler: str | None = None,
    observer: Observer | None = None,
) -> Diagnosis:
    """Find, name, model and remove what a simulator leaves out of recordings.

    `recorded`: a data set's name, a file, a frame or `Recordings`. `simulated`: a simulator (TOML
    file, plug-in name, `Simulator`), which is run again at every recorded row, or a table of
    another simulator's rows; None is the base simulator alone. `hide`: columns it must not see;
    `measured`, `known`: columns of your own that are measured with the range, or known before it;
    `observe`: compare only these observables; `paths_only`: no waveforms even where both sides
    have them, range and level alone. With `out` the report, the new simulator and figures go to
    that folder, and a diagnosis that was stopped goes on from it. `jobs` processes or a Dask
    `scheduler` share the fits to waveforms; what is found does not depend on it. Raises BenchError
    on bad input, before anything is written.

    >>> diagnose("apartmant", simulated="rooms")
    Traceback (most recent call last):
    bench.errors.BenchError: unknown data set 'apartmant'; did you mean 'apartment'? ...
    >>> found = diagnose("mine.parquet", simulated="rooms")  # doctest: +SKIP
    >>> found.selection.names  # doctest: +SKIP
    (('antenna-delay',),)
    """
    if seed < 0:
        raise BenchError(f"--seed {seed}: expected a whole number of 0 or more")
    if out is not None:
        _check_folder(out)
    watch, spread = observer or Observer(), Spread(jobs, scheduler)
    chosen = _names("--observe", observe) or None
    waves = False if paths_only else None
    options = Options(
        seed, hide=_names("--hide", hide), measured=_names("--measured", measured),
        known=_names("--known", known), observables=chosen, waveform=waves,
    )  # fmt: skip
    table, against = read(recorded, environment), counterpart(simulated)
    table.require(*options.hide)
    if not chosen:
        check_hidden(table.frame, options.hide, table.at)
    if out is None:
        with spreading(spread), one_blas_thread():
            return method.diagnose(table, against, options, watch.stage)
    kept = _kept(Path(out), fingerprint(table, against, options), watch)
    with spreading(spread), one_blas_thread():
        found = method.diagnose(table, against, options, watch.stage, journal=kept)
    watch.note(f"report: {write_report(found, Path(out))}")
    write_inputs(Path(out), recorded, simulated, environment, table, against, found.base)
    kept.clear()
    return found


def _check_folder(out: str | Path) -> None:
    """Raise BenchError, before any work is done, where a report could not be written there."""
    if not str(out).strip():
        raise BenchError("-o '': expected the name of a folder")
    for part in PARTS:
        check_output(Path(out) / part)


def counterpart(simulated: Table | Simulator | None) -> Simulator | Recordings:
    """Return what recordings are compared with: a simulator, or a simulated table."""
    if simulated is None:
        return Simulator(Base(), name="base")
    if isinstance(simulated, Simulator):
        return simulated
    if isinstance(simulated, pd.DataFrame | Recordings) or _is_table(simulated):
        return read(simulated)
    return read_simulator(simulated)


def _is_table(name: str | Path) -> bool:
    """Return whether a name or path is that of a table's file."""
    return str(name).endswith((*PARQUET_SUFFIXES, *CSV_SUFFIXES))


def _names(option: str, given: str | Iterable[str]) -> tuple[str, ...]:
    """Return names: several in one text with commas, or one by one.

    Raises BenchError where something is given that names nothing.
    """
    every = given.split(",") if isinstance(given, str) else list(given)
    names = tuple(name.strip() for name in every if name.strip())
    if given and not names:
        raise BenchError(f"{option} {given}: names nothing; expected names with commas between")
    return names


def _kept(out: Path, mark: str, watch: Observer) -> Kept:
    """Return what an earlier run left in the folder, and say so where there is something."""
    kept = Kept(out, mark)
    if kept.started:
        watch.note(
            f"resuming: {kept.steps} finished steps of an earlier run are kept and not done again "
            f"(whole rounds: {kept.finished})"
        )
    return kept


def fingerprint(recorded: Recordings, simulated: Simulator | Recordings, options: Options) -> str:
    """Return 16 hex digits of all that decides the outcome: what was stopped goes on as itself.

    Code, packages, effects, both sides' content, options and seed.
    """
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
