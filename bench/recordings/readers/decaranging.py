"""Reading the text logs of Decawave's DecaRanging program (version 3, 'all accumulators').

The logging device is the anchor, the responder of an asymmetric double-sided exchange:

1. it receives the tag's poll (frame type 21): `RX OK ...`, then the accumulator as I, Q lines;
2. it sends the response (`TX Frame TimeStamp Raw`, no accumulator at this end);
3. it receives the tag's final (frame type 29), accumulator as before;
4. it prints the range (`Anchor ToF: .. Dist: ..`) and the four intervals `Ra Db`, `Rb Da`.

A range is matched with the final frame, the last frame received before it was printed: its
accumulator, first path and levels stand in the row; the poll's levels stand beside them under
`poll_*`. Frames without a range (an exchange cut short, `RX E` reception errors) give no row.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError

FINAL = "29"

_LINES = re.compile(
    rb"^(?:"
    rb"(?P<kind>[0-9A-F]{2}) \w{2} Rx time = (?P<rx_time>\S+) (?P<stamp>[0-9A-F]+)"
    rb"|RX (?P<status>OK) WInd\(\d+\), HLP\((?P<hlp>[-+.\w#]+)\), PSC\((?P<psc>\d+)\)"
    rb".*?NTH\((?P<nth>[0-9A-F]+)\).*?RSL\((?P<rsl>[-+.\w#]+)\), FSL\((?P<fsl>[-+.\w#]+)\)"
    rb"|RX (?P<error>E)"
    rb"|Anchor ToF: \S+ ns Dist: (?P<dist>\S+) m DistRaw: (?P<raw>\S+) m .*?"
    rb"Bias: (?P<bias>\S+) m ClockOffset: (?P<offset>\S+) ppm"
    rb"|Ra +(?P<ra>[0-9a-f]{16}) Db (?P<db>[0-9a-f]{16})"
    rb"|Rb +(?P<rb>[0-9a-f]{16}) Da (?P<da>[0-9a-f]{16})"
    rb")",
    re.MULTILINE,
)
_STARTED = re.compile(rb"File:(\d{8}-\d{6})_")


@dataclass
class Frame:
    """One received frame: type, reception time (s, wraps at 17.2 s), levels, accumulator text."""

    kind: str
    rx_time_s: float
    first_path_index: float = np.nan
    preamble_count: float = np.nan
    noise_threshold: float = np.nan
    rx_power_dbm: float = np.nan
    first_path_power_dbm: float = np.nan
    accumulator: bytes = b""


@dataclass
class Range:
    """One printed range, its intervals in ticks (15.65 ps), and the frames it belongs to."""

    range_m: float
    raw_m: float
    bias_m: float
    clock_offset_ppm: float
    final: Frame
    poll: Frame | None
    ticks: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Log:
    """The ranges of one log, when it was started (YYYYMMDD-hhmmss), and what has no row."""

    ranges: list[Range]
    started: str
    without_frame: int


def parse_log(path: Path) -> Log:
    """Return the ranges of one log with their frames.

    Raises BenchError where the file is no DecaRanging log with accumulators and ranges.
    """
    text = path.read_bytes()
    reader = _Reader()
    for block, lines in _pieces(text):
        reader.take_accumulator(block)
        for line in _LINES.finditer(lines):
            reader.take_line(line)
    if not reader.ranges:
        raise BenchError(
            f"{path}: no range found; expected a DecaRanging log with lines 'RX OK ..', "
            "'Accum Len 1016' and 'Anchor ToF: .. Dist: ..'"
        )
    started = _STARTED.search(text)
    return Log(reader.ranges, started[1].decode() if started else "", reader.without_frame)


class _Reader:
    """Walks through a log's lines, remembering the frames since the last range."""

    def __init__(self) -> None:
        self.ranges: list[Range] = []
        self.without_frame = 0
        self._frames: list[Frame] = []
        self._open: Frame | None = None

    def take_accumulator(self, block: bytes) -> None:
        """Take the I, Q lines of the frame whose levels came just before."""
        if self._open:
            self._open.accumulator = block
            self._frames.append(self._open)
        self._open = None

    def take_line(self, line: re.Match[bytes]) -> None:
        """Take one line of interest."""
        if line["kind"]:
            self._open = Frame(line["kind"].decode(), _number(line["rx_time"]))
        elif line["status"] and self._open:
            self._levels(line, self._open)
        elif line["error"]:
            self._open = None
        elif line["dist"]:
            self._range(line)
        elif self.ranges and (line["ra"] or line["rb"]):
            found = {name: line[name] for name in ("ra", "db", "rb", "da") if line[name]}
            self.ranges[-1].ticks.update({name: int(value, 16) for name, value in found.items()})

    def _levels(self, line: re.Match[bytes], frame: Frame) -> None:
        frame.first_path_index = _number(line["hlp"])
        frame.preamble_count = float(line["psc"])
        frame.noise_threshold = float(int(line["nth"], 16))
        frame.rx_power_dbm = _number(line["rsl"])
        frame.first_path_power_dbm = _number(line["fsl"])

    def _range(self, line: re.Match[bytes]) -> None:
        """Match a range with the final frame just before it."""
        frames, self._frames = self._frames, []
        if not frames or frames[-1].kind != FINAL:
            self.without_frame += 1
            return
        distance, raw, bias, offset = map(_number, line.group("dist", "raw", "bias", "offset"))
        poll = frames[-2] if len(frames) > 1 else None
        self.ranges.append(Range(distance, raw, bias, offset, frames[-1], poll))


def _pieces(text: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield (I, Q lines of an accumulator, the other lines up to the next); the first has none.

    Accumulators are nearly all of a log: cut out first, they need no line-by-line search.
    """
    head, *rest = text.split(b"Accum Len ")
    yield b"", head
    for piece in rest:
        start = piece.find(b"\n") + 1
        ends = (piece.find(blank, start) for blank in (b"\n\r\n", b"\n\n"))
        end = min((end for end in ends if end >= 0), default=len(piece))
        yield piece[start:end], piece[end:]


def _number(text: bytes) -> float:
    """Return the number; the C runtime's spelling of infinity (-001.#INF) as one."""
    try:
        return float(text)
    except ValueError:
        if b"#INF" in text:
            return float("-inf") if text.startswith(b"-") else float("inf")
        return float("nan")


def accumulator(frame: Frame) -> NDArray[np.float32]:
    """Return the complex accumulator as float32 [2, samples]: I, Q; empty where it is damaged."""
    text = frame.accumulator.replace(b"\n", b",")
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # numpy's word for malformed text
        try:
            numbers = np.fromstring(text, np.int32, sep=",").astype(np.float32)
        except (DeprecationWarning, ValueError):
            numbers = np.empty(0, np.float32)
    return numbers[: len(numbers) // 2 * 2].reshape(-1, 2).T
