"""Simulating more rows than memory holds: geometry in, recordings out, chunk by chunk."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import pandas as pd

from bench.errors import BenchError
from bench.files import atomic_path
from bench.forked import able
from bench.parallel import a_few_at_once, in_processes, threads
from bench.physics.memory import keep_freed
from bench.physics.ours import is_ours
from bench.physics.outcome import Outcome
from bench.physics.randomness import BLOCK
from bench.physics.room_geometry import room_geometry
from bench.physics.room_plan import ROW_TOTAL, Plan
from bench.physics.scene import Scene, scene
from bench.physics.simulator import Simulator
from bench.physics.toml_file import to_toml
from bench.physics.units import Floats
from bench.recordings.motion import SPEED
from bench.recordings.parquet import lists, to_arrow
from bench.recordings.parquet import writer as writing
from bench.recordings.table import CIR_COLUMNS, Recordings

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

Item = TypeVar("Item")
Chunk = tuple[Scene, int]
"""Rows to simulate at, and how many there are before them."""
CHUNK = 16 * BLOCK
MANY_ROWS = 100_000
"""From so many on, processes (which take up to a second to start) are sooner done than threads."""


@dataclass
class Tally:
    """Running sums over the rows written: errors in metres, by line of sight where known."""

    rows: int = 0
    error_m: float = 0.0
    magnitude_m: float = 0.0

    def add(self, error_m: Floats) -> None:
        """Count more rows."""
        self.rows += len(error_m)
        self.error_m += float(np.sum(error_m))
        self.magnitude_m += float(np.sum(np.abs(error_m)))

    @property
    def mean_m(self) -> float:
        """Mean error in metres."""
        return self.error_m / max(self.rows, 1)

    @property
    def mae_m(self) -> float:
        """Mean absolute error in metres."""
        return self.magnitude_m / max(self.rows, 1)


def simulate_to(
    simulator: Simulator,
    geometry: Iterable[pd.DataFrame],
    target: Path,
    progress: Callable[[int], None] | None = None,
    source: str = "geometry",
    rows: int = 0,
) -> Tally:
    """Simulate `geometry` and write recordings Parquet to `target` in one step.

    Row i gets the same numbers however the geometry is cut into frames. Memory holds some chunks.
    Of `MANY_ROWS` and more, if `rows` says how many there are, other processes make some.
    Raises BenchError naming `source` where it has no rows or no true range, or writing fails.
    """
    keep_freed()
    tally = Tally()
    with atomic_path(target) as scratch, ExitStack() as opened:
        writer: pq.ParquetWriter | None = None
        chunks = _simulated(simulator, rechunked(geometry, CHUNK), source, rows >= MANY_ROWS)
        for frame, made in opened.enter_context(closing(chunks)):
            table = _table(simulator, frame, made)
            if writer is None:
                writer = opened.enter_context(writing(scratch, table.schema))
            writer.write_table(table.cast(writer.schema))
            tally.add(made.error_m)
            if progress is not None:
                progress(tally.rows)
        if writer is None:
            raise BenchError(f"{source}: no rows to simulate at")
    return tally


def _simulated(
    simulator: Simulator, frames: Iterable[pd.DataFrame], source: str, many: bool
) -> Generator[tuple[pd.DataFrame, Outcome], None, None]:
    """Yield every chunk of geometry with what is simulated there, a few chunks at once."""
    waiting: deque[pd.DataFrame] = deque()
    moving = _asks_for_speed(simulator)

    def chunks() -> Iterator[Chunk]:
        for number, frame in enumerate(frames):
            waiting.append(frame)
            yield scene(frame, source, moving=moving), number * CHUNK

    with closing(ahead(chunks())) as coming, closing(_observed(simulator, coming, many)) as made:
        for outcome in made:
            yield waiting.popleft(), outcome


def _observed(
    simulator: Simulator, chunks: Iterable[Chunk], many: bool
) -> Generator[Outcome, None, None]:
    """Yield what is simulated at every chunk: in processes where there are `many`, else in threads.

    Effects of the user's own stay in this process, which another might not find.
    """
    if many and threads() > 1 and _all_ours(simulator):
        forks = able() and "torch" not in sys.modules  # whose threads no fork has
        row = scene(pd.DataFrame({"true_range_m": [1.0]})), 0  # machine code is loaded meanwhile
        yield from in_processes(_observe, simulator, chunks, threads(), forks, row)
    else:
        yield from a_few_at_once(partial(_observe, simulator), chunks)


def _all_ours(simulator: Simulator) -> bool:
    """Return whether all of a simulator is of this package."""
    return all(is_ours(type(part)) for part in (simulator.base, *simulator.effects))


def _observe(simulator: Simulator, chunk: Chunk) -> Outcome:
    """Return what is simulated at a chunk."""
    rows, first_row = chunk
    return simulator.observe(rows, first_row=first_row)


def _asks_for_speed(simulator: Simulator) -> bool:
    """Return whether an effect may read the radial speed: ours say what they need."""
    return any(
        not is_ours(type(effect)) or any(SPEED in way for way in effect.needs)
        for effect in simulator.effects
    )


def _table(simulator: Simulator, frame: pd.DataFrame, made: Outcome) -> pa.Table:
    """Return the simulated recordings of a chunk as an Arrow table."""
    plain, text = replace(made, cir=None).table(frame), to_toml(simulator)
    table = to_arrow(
        Recordings(plain, simulator.name, "simulated", simulator=text, seed=simulator.seed)
    )
    return table if made.cir is None else table.append_column("cir", lists(made.cir))


def ahead(items: Iterable[Item]) -> Generator[Item, None, None]:
    """Yield `items`, each made in a thread while the one before is in use. Close it when done."""
    steps, end = iter(items), object()
    with ThreadPoolExecutor(1) as thread:
        coming: Future[Any] = thread.submit(next, steps, end)
        while (item := coming.result()) is not end:
            coming = thread.submit(next, steps, end)
            yield item


def rechunked(frames: Iterable[pd.DataFrame], rows: int) -> Iterator[pd.DataFrame]:
    """Yield the rows of `frames` in frames of exactly `rows` rows, the last one shorter."""
    kept = pd.DataFrame()
    for frame in frames:
        kept = frame if kept.empty else pd.concat([kept, frame], ignore_index=True)
        while len(kept) >= rows:
            yield kept.iloc[:rows].reset_index(drop=True)
            kept = kept.iloc[rows:].reset_index(drop=True)
    if len(kept):
        yield kept


def geometry_of(path: Path) -> Iterator[pd.DataFrame]:
    """Yield the rows of a recordings Parquet without their CIRs, some thousand at a time.

    Raises BenchError where the file is missing or no Parquet.
    """
    with _opened(path) as file:
        names = [name for name in file.schema_arrow.names if name not in CIR_COLUMNS]
        for batch in file.iter_batches(CHUNK, columns=names):
            yield batch.to_pandas()


def row_count(path: Path) -> int:
    """Return the number of rows of a Parquet file. Raises BenchError like `geometry_of`."""
    with _opened(path) as file:
        return int(file.metadata.num_rows)


@contextmanager
def _opened(path: Path) -> Iterator[pq.ParquetFile]:
    """Yield the open file; its errors become one line."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with pq.ParquetFile(path) as file:
            yield file
    except (OSError, pa.ArrowException) as problem:
        reason = (str(problem).splitlines() or [""])[0]
        raise BenchError(f"{path}: cannot be read as recordings Parquet: {reason}") from problem


def rooms(rows: int, seed: int, of: Plan | None = None) -> Iterator[pd.DataFrame]:
    """Yield `rows` rows of room geometry; beyond 55 000, from further campaigns."""
    for campaign, start in enumerate(range(0, rows, ROW_TOTAL)):
        wanted = min(ROW_TOTAL, rows - start)
        rng = np.random.default_rng([seed, campaign] if campaign else seed)
        frame = room_geometry(rng, wanted, of)
        if campaign:
            frame = frame.assign(link=f"campaign-{campaign}-" + frame["link"])
        yield frame
