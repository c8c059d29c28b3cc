"""Hostile values: texts, numbers, option values, and things in the file system that are no files.

Nothing here names a device of the machine: what is a device, FIFO or link is made in the case's
own folder, so that a command that does the wrong thing harms nothing else.
"""

from __future__ import annotations

import os
import random
import socket
from pathlib import Path

TEXTS = (
    "",
    " ",
    ",",
    "[bold]m[/x]",
    "[/]",
    "[link=file:///etc]x[/link]",
    "\x1b[31mred\x1b[0m",
    "\x1b]0;title\x07",
    "a\nb",
    "a\rb",
    "tab\tbed",
    "\u202egnp.exe",
    "\u2028",
    "\x7f\x80\x9b31m",
    "\x00",
    "naïve Straße 测距 🛰",
    "\ud800",
    "| pipe | `tick` <b>html</b> |",
    "<script>alert(1)</script>",
    "../../up",
    "/abs",
    "~",
    "-rf",
    "--help",
    "x" * 300,
    "x" * 5000,
    "nan",
    "None",
    "%s%n{0}{x!r}",
    "é",
)
NUMBERS = (0.0, -0.0, -1.0, 1e-320, 1e308, 1e18, 0.5, 3, -7, float("inf"), float("-inf"))
NUMBERS += (float("nan"),)
COUNTS = ("-1", "0", "1.5", "1e3", "10000000000000", "9" * 400, "nan", "", "abc", "²", "0x10", "１")
CODES = ("[" * 100_000, "{" * 1000, "9" * 5000, "1e400", "-1e400", "NaN", "Infinity", '"\\ud800"')


def text(rng: random.Random) -> str:
    """Return one of the texts, now and then two of them together."""
    return rng.choice(TEXTS) if rng.random() < 0.8 else rng.choice(TEXTS) + rng.choice(TEXTS)


def argument(rng: random.Random) -> str:
    """Return a text that a shell can hand to a program: no NUL, no lone surrogate, no option."""
    return text(rng).replace("\x00", "0").replace("\ud800", "?").lstrip("-")


def file_name(rng: random.Random, suffix: str) -> str:
    """Return a name the file system takes, often an odd one."""
    odd = argument(rng).replace("/", "_")[:80]
    return (odd if odd.strip(". ") and rng.random() < 0.5 else "data") + suffix


def odd_file(rng: random.Random, path: Path) -> str:
    """Put something at `path` that is no whole regular file; return what."""
    kind = rng.choice(
        ("absent", "empty", "folder", "fifo", "loop", "dangling", "endless", "noise", "socket")
    )
    if path.is_dir() and not path.is_symlink():
        path.rmdir()
    path.unlink(missing_ok=True)
    match kind:
        case "empty":
            path.touch()
        case "folder":
            path.mkdir()
        case "fifo":
            os.mkfifo(path)
        case "loop":
            path.symlink_to(path.name)
        case "dangling":
            path.symlink_to("nowhere")
        case "endless":
            path.symlink_to("/dev/zero")  # read only: no command is given it as an output
        case "noise":
            path.write_bytes(rng.randbytes(300))
        case "socket":
            _socket(path)
    return kind


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(os.path.relpath(path))


def odd_output(rng: random.Random, folder: Path, suffix: str) -> Path:
    """Return somewhere to write: mostly fine, else odd; never a device of the machine."""
    kind = rng.choice(("plain", "plain", "deep", "folder", "fifo", "loop", "link", "under-file"))
    path = folder / file_name(rng, suffix)
    if path.exists() or path.is_symlink():
        path = folder / f"other{suffix}"
    match kind:
        case "deep":
            path = folder / "a" / "b" / path.name
        case "folder":
            path.mkdir()
        case "fifo":
            os.mkfifo(path)
        case "loop":
            path.symlink_to(path.name)
        case "link":
            (folder / "linked").write_text("old")
            path.symlink_to("linked")
        case "under-file":
            (folder / "file").write_text("old")
            path = folder / "file" / path.name
    return path


def damaged(rng: random.Random, content: bytes) -> bytes:
    """Return the bytes cut short, or with some of them changed."""
    if rng.random() < 0.5:
        return content[: rng.randrange(len(content))]
    out = bytearray(content)
    for _ in range(rng.randrange(1, 20)):
        out[rng.randrange(len(out))] = rng.randrange(256)
    return bytes(out)
