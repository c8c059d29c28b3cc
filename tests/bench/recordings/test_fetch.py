"""Downloads, against a server on this machine."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import ClassVar

import pooch
import pytest

from bench.errors import BenchError
from bench.recordings.fetch import CHUNK_BYTES, fetch
from bench.recordings.sources.base import Publisher, Source, download_folder
from bench.recordings.table import Recordings

CONTENT = bytes(range(256)) * 4096  # 1 MiB
STEP = 2 * CHUNK_BYTES  # a connection that breaks loses what does not fill a chunk
SHA256 = hashlib.sha256(CONTENT).hexdigest()


@dataclass
class Site:
    """What the server offers and how it behaves; `asked` keeps the Range of every request."""

    files: dict[str, bytes] = field(default_factory=lambda: {"data.bin": CONTENT})
    cut_after: int | None = None
    cuts: int = 1
    ranges: bool = True
    asked: list[str | None] = field(default_factory=list)
    url: str = ""


@pytest.fixture
def site() -> Iterator[Site]:
    served = Site()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            content = served.files.get(self.path.lstrip("/"))
            wanted = self.headers.get("Range")
            served.asked.append(wanted)
            if content is None:
                self.send_error(404)
                return
            start = int(wanted[6:-1]) if wanted and served.ranges else 0
            if start >= len(content):
                self.send_response(416)
                self.send_header("Content-Range", f"bytes */{len(content)}")
                self.end_headers()
                return
            self.send_response(206 if start else 200)
            self.send_header("Content-Length", str(len(content) - start))
            self.end_headers()
            end = len(content)
            if served.cut_after is not None and served.cuts > 0:
                served.cuts -= 1
                end = min(end, start + served.cut_after)
            self.wfile.write(content[start:end])

        def log_message(self, *args: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    served.url = f"http://127.0.0.1:{server.server_port}"
    thread = Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    yield served
    server.shutdown()
    server.server_close()


def _source(site: Site, **hashes: str) -> Source:
    """Return a data set whose files the local server has; `hashes` by file name without ending."""

    class Local(Source):
        name = "local"
        title = "A data set on this machine's server"
        licence = "none"
        publisher: ClassVar[Publisher | None] = Publisher(
            "http://127.0.0.1/page",
            urls={name: f"{site.url}/{name}" for name in site.files},
            hashes={name: hashes[name[:4]] for name in site.files if name[:4] in hashes},
        )

        def available(self) -> str | None:
            return None

        def load(self) -> Recordings:
            raise NotImplementedError

    return Local()


def _left() -> list[str]:
    folder = download_folder("local")
    return sorted(path.name for path in folder.rglob("*")) if folder.exists() else []


def test_a_checked_download_lands_in_the_data_sets_folder(site: Site) -> None:
    seen: list[tuple[str, int, int | None]] = []
    (path,) = fetch(
        _source(site, data=f"sha256:{SHA256}"), progress=lambda *step: seen.append(step)
    )
    assert path == download_folder("local") / "data.bin"
    assert path.read_bytes() == CONTENT
    assert seen[-1] == ("data.bin", len(CONTENT), len(CONTENT))
    assert _left() == ["data.bin"]


def test_md5_checksums_as_repositories_give_them_are_understood(site: Site) -> None:
    md5 = hashlib.md5(CONTENT).hexdigest()
    assert fetch(_source(site, data=f"md5:{md5}"))[0].read_bytes() == CONTENT


def test_what_is_here_already_is_not_downloaded_again(site: Site) -> None:
    source = _source(site, data=f"sha256:{SHA256}")
    fetch(source)
    fetch(source)
    assert len(site.asked) == 1


def test_a_damaged_file_that_is_here_is_downloaded_again(site: Site) -> None:
    source = _source(site, data=f"sha256:{SHA256}")
    (path,) = fetch(source)
    path.write_bytes(b"damaged")
    assert fetch(source)[0].read_bytes() == CONTENT


@pytest.mark.parametrize("digest", ["0" * 64, "f" * 64])
def test_a_wrong_checksum_is_refused_and_nothing_is_left(site: Site, digest: str) -> None:
    with pytest.raises(BenchError, match=r"data\.bin does not have the checksum sha256:.*deleted"):
        fetch(_source(site, data=f"sha256:{digest}"))
    assert _left() == []


def test_a_connection_that_breaks_is_continued_where_it_stopped(site: Site) -> None:
    site.cut_after = STEP
    (path,) = fetch(_source(site, data=f"sha256:{SHA256}"))
    assert path.read_bytes() == CONTENT
    assert site.asked == [None, f"bytes={STEP}-"]


def test_a_later_call_continues_what_an_earlier_one_left(site: Site) -> None:
    source = _source(site, data=f"sha256:{SHA256}")
    site.cut_after, site.cuts = STEP, 3
    with pytest.raises(BenchError, match="the publisher cannot be reached"):
        fetch(source)
    (partial,) = download_folder("local").iterdir()
    assert partial.read_bytes() == CONTENT[: 3 * STEP]
    assert fetch(source)[0].read_bytes() == CONTENT
    assert site.asked == [None, *(f"bytes={n * STEP}-" for n in (1, 2, 3))]
    assert _left() == ["data.bin"]


def test_a_server_that_cannot_continue_sends_all_of_it_again(site: Site) -> None:
    site.cut_after, site.ranges = STEP, False
    assert fetch(_source(site, data=f"sha256:{SHA256}"))[0].read_bytes() == CONTENT


def test_a_partial_file_that_is_complete_is_taken(site: Site) -> None:
    source = _source(site, data=f"sha256:{SHA256}")
    site.cut_after, site.cuts = STEP, 3
    with pytest.raises(BenchError):
        fetch(source)
    (partial,) = download_folder("local").iterdir()
    partial.write_bytes(CONTENT)
    assert fetch(source)[0].read_bytes() == CONTENT


@pytest.mark.parametrize("wrong", [CONTENT + b"more", b"x" * 1000])
def test_a_partial_file_of_something_else_never_gets_through(site: Site, wrong: bytes) -> None:
    source = _source(site, data=f"sha256:{SHA256}")
    site.cut_after, site.cuts = STEP, 3
    with pytest.raises(BenchError):
        fetch(source)
    (partial,) = download_folder("local").iterdir()
    partial.write_bytes(wrong)
    site.cuts = 0
    try:
        assert fetch(source)[0].read_bytes() == CONTENT
    except BenchError:
        assert _left() == []
    assert fetch(source)[0].read_bytes() == CONTENT


def test_without_a_checksum_nothing_is_downloaded_silently(site: Site) -> None:
    with pytest.raises(BenchError, match=r"no checksum is known for data\.bin.*--sha256.*accept"):
        fetch(_source(site))
    assert site.asked == []


def test_without_a_checksum_the_user_may_give_one_or_accept(site: Site) -> None:
    assert fetch(_source(site), sha256=SHA256)[0].read_bytes() == CONTENT
    assert fetch(_source(site), accept_unverified=True)[0].read_bytes() == CONTENT
    download_folder("local").joinpath("data.bin").unlink()
    with pytest.raises(BenchError, match="does not have the checksum"):
        fetch(_source(site), sha256="0" * 64)


@pytest.mark.parametrize("digest", ["abc", "g" * 64])
def test_a_checksum_of_another_form_is_refused(site: Site, digest: str) -> None:
    with pytest.raises(BenchError, match="expected 64 hexadecimal digits"):
        fetch(_source(site), sha256=digest)


def test_one_checksum_does_not_do_for_two_files(site: Site) -> None:
    site.files["more.bin"] = b"more"
    with pytest.raises(
        BenchError, match=r"--sha256 is for one file, but there are: data.bin, more"
    ):
        fetch(_source(site), sha256=SHA256)


def test_archives_are_unpacked_inside_the_folder(site: Site) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("inside/1.log", "log")
        archive.writestr("../../outside.txt", "hostile")
    site.files = {"logs.zip": packed.getvalue()}
    files = fetch(_source(site), accept_unverified=True)
    folder = download_folder("local")
    assert all(folder in path.resolve().parents for path in files)
    assert (folder / "logs" / "inside" / "1.log").read_text() == "log"
    assert not (folder.parent.parent / "outside.txt").exists()


def test_a_broken_archive_gives_a_clear_line(site: Site) -> None:
    site.files = {"logs.zip": b"no archive"}
    with pytest.raises(BenchError, match=r"logs\.zip"):
        fetch(_source(site), accept_unverified=True)


def test_a_missing_file_says_what_to_do_by_hand(site: Site) -> None:
    source = _source(site, data=f"sha256:{SHA256}")
    site.files = {}
    with pytest.raises(
        BenchError, match=r"by hand from http://127.0.0.1/page and put the files in"
    ):
        fetch(source)


def test_a_read_only_folder_gives_a_clear_line(site: Site, tmp_path, monkeypatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "file"))
    with pytest.raises(BenchError, match="cannot write"):
        fetch(_source(site, data=f"sha256:{SHA256}"))


# A record found by its DOI


class _Record:
    """What pooch gives for a record: its files, their checksums and addresses."""

    def __init__(self, url: str, registry: dict[str, str | None]) -> None:
        self.url, self.registry = url, registry

    def populate_registry(self, target: pooch.Pooch) -> None:
        target.registry.update(self.registry)

    def download_url(self, name: str) -> str:
        return f"{self.url}/{name}"


class _Doi(Source):
    name = "local"
    title = "A record"
    licence = "none"
    publisher: ClassVar[Publisher | None] = Publisher("https://doi.org/10.1/x", doi="10.1/x")

    def available(self) -> str | None:
        return None

    def load(self) -> Recordings:
        raise NotImplementedError


def _record(monkeypatch, site: Site, registry: dict[str, str | None]) -> None:
    monkeypatch.setattr(
        "pooch.downloaders.doi_to_repository", lambda doi, **options: _Record(site.url, registry)
    )


def test_a_records_own_checksums_are_used(site: Site, monkeypatch) -> None:
    _record(monkeypatch, site, {"data.bin": f"md5:{hashlib.md5(CONTENT).hexdigest()}"})
    assert fetch(_Doi())[0].read_bytes() == CONTENT
    _record(monkeypatch, site, {"data.bin": "md5:" + "0" * 32})
    with pytest.raises(BenchError, match="does not have the checksum md5:0"):
        fetch(_Doi())


@pytest.mark.parametrize("name", ["../evil.bin", "/etc/passwd", "a/b", ".hidden", "x\ny", "..\\a"])
def test_a_record_cannot_name_files_outside_the_folder(site: Site, monkeypatch, name: str) -> None:
    _record(monkeypatch, site, {name: "md5:" + "0" * 32})
    with pytest.raises(BenchError, match="expected a plain file name"):
        fetch(_Doi(), accept_unverified=True)


def test_offline_says_what_to_download_and_where_to_put_it(monkeypatch) -> None:
    import requests

    def offline(*args: object, **options: object) -> None:
        raise requests.ConnectionError("no network")

    monkeypatch.setattr("requests.get", offline)
    with pytest.raises(BenchError) as caught:
        fetch(_Doi())
    assert "https://doi.org/10.1/x" in str(caught.value)
    assert str(download_folder("local")) in str(caught.value)


def test_a_data_set_made_here_has_nothing_to_fetch(monkeypatch) -> None:
    monkeypatch.setattr(_Doi, "publisher", None)
    with pytest.raises(BenchError, match="nothing to fetch, it is made on this machine"):
        fetch(_Doi())


def test_a_page_without_direct_files_is_a_download_by_hand(monkeypatch) -> None:
    monkeypatch.setattr(_Doi, "publisher", Publisher("https://doi.org/10.1/x"))
    with pytest.raises(BenchError, match=r"no direct download is known; download it by hand from"):
        fetch(_Doi())
