from __future__ import annotations

import io
from pathlib import Path

import pytest
import result_files as files
from rich.console import Console

from reports import make_boards, read_results
from reports.document import Bullets, Cell, Column, Document, Heading, Image, Paragraph, Table
from reports.leaderboard import leaderboard
from reports.markdown import render
from reports.terminal import parts, print_document


def printed(document: Document, width: int = 80) -> str:
    stream = io.StringIO()
    print_document(document, Console(file=stream, width=width))
    return stream.getvalue()


TABLE = Table(
    (Column("Name", number=False), Column("A (m)", "a"), Column("B (s)", "b"), Column("C", "b")),
    ((Cell("[x]"), Cell("1.5", ("[1, 2]", "±3"), best=True), Cell("2"), Cell("3")),),
)


def test_a_wide_table_is_cut_into_its_groups_with_the_keys_repeated() -> None:
    text = printed([TABLE])
    headers = [line.split() for line in text.splitlines() if "Name" in line]
    assert headers == [["Name", "A", "(m)"], ["Name", "B", "(s)", "C"]]
    assert text.count("[x]") == 2  # shown as it is, not read as markup
    assert text.count("[1, 2]") == 1


def test_a_table_without_groups_is_one_table() -> None:
    plain = Table((Column("K"), Column("V")), ((Cell("1"), Cell("2")),))
    assert len(list(parts(plain))) == 1


def test_every_block_is_printed() -> None:
    text = printed(
        [
            Heading("Top", 1),
            Heading("Sub", 2),
            Paragraph("words"),
            Bullets(("a", "b")),
            Image("p.svg", "pic"),
        ]
    )
    assert [line.strip() for line in text.splitlines() if line.strip()] == [
        "Top",
        "Sub",
        "words",
        "- a",
        "- b",
        "pic: p.svg",
    ]


def test_a_leaderboard_fits_eighty_columns(tmp_path: Path) -> None:
    results = read_results(files.full_folder(tmp_path))
    text = printed(leaderboard(make_boards(results)))
    assert max(map(len, text.splitlines())) <= 80
    assert "[0.0663, 0.0743]" in text  # an interval is not broken over lines
    assert "SIMULATED" in text


def test_an_unknown_block_is_refused() -> None:
    for unknown in (parts, render):
        with pytest.raises(TypeError, match="int"):
            unknown(3)
