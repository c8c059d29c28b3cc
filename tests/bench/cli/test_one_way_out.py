"""Every command prints through `bench.cli.console`, or what plug-ins print would mix with it."""

from __future__ import annotations

import re
from pathlib import Path

import bench.cli

PAST = r"click\.echo\(|(?<![\w.])print\(|\bConsole\(|sys\.stdout"
OWN = {"console.py", "failing.py", "main.py"}


def test_no_command_prints_past_the_console() -> None:
    folder = Path(bench.cli.__file__).parent
    for path in sorted(folder.glob("*.py")):
        if path.name not in OWN:
            found = re.search(
                r"click\.echo\(|(?<![\w.])print\(|\bConsole\(|sys\.stdout", path.read_text()
            )
            assert found is None, f"{path.name}: {found[0]}: use say() or console()"
