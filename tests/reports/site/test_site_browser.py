"""The page in a real browser: sorted, filtered, explored, by keyboard, narrow and wide."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator

import pytest
from test_site import data_of, folder_of

from reports.site import Page, render

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    not (CHROMIUM and DRIVER), reason="no chromium and chromedriver (Debian: chromium-driver)"
)
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The address of a page with two boards and a report."""
    folder = folder_of(tmp_path_factory.mktemp("site"), ["remnet", "svm", "mlp", "cnn1d"])
    folder_of(folder, ["remnet", "svm"], data="flat", data_fingerprint="f1a7")
    path = folder / "index.html"
    path.write_text(render(data_of(folder), [Page("Challenge", "# Challenge\n\ntext")]), "utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[object]:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = str(CHROMIUM)
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options, Service(str(DRIVER)))
    yield driver
    driver.quit()


def column(browser, name: str) -> list[str]:
    """Return the cells under a header, first lines."""
    heads = [cell.text.strip(" ▲▼") for cell in browser.find_elements("css selector", "thead th")]
    at = heads.index(name) + 1
    cells = browser.find_elements("css selector", f"tbody tr > :nth-child({at})")
    return [cell.text.split("\n")[0] for cell in cells]


def opened(browser, page: str, part: str = "", width: int = 1600) -> None:
    browser.set_window_size(width, 900)
    browser.get("about:blank")
    browser.get(page + part)


def test_sorting_by_a_click_and_back(browser, page: str) -> None:
    opened(browser, page)
    names = sorted(column(browser, "Model"))
    browser.find_element("css selector", "[data-sort=model]").click()
    assert column(browser, "Model") == names
    browser.find_element("css selector", "[data-sort=model]").click()
    assert column(browser, "Model") == names[::-1]
    assert browser.find_element("css selector", "[aria-sort=descending]").text.startswith("Model")


def test_filter_and_columns(browser, page: str) -> None:
    opened(browser, page)
    browser.find_element("id", "filter").send_keys("svm")
    assert column(browser, "Model") == ["svm"]
    browser.find_element("css selector", "details summary").click()
    browser.find_element("css selector", "#columns input[value=macs]").click()
    assert column(browser, "Multiply-adds") == ["1,234,567"]
    assert "filter=svm" in browser.current_url


def test_a_deep_link_opens_what_it_says(browser, page: str) -> None:
    opened(browser, page, "#view=run&board=1&run=remnet%2Ffp32")
    assert (
        browser.find_element("css selector", "#view-run h2").text
        == "remnet/fp32 on rooms (SIMULATED)"
    )
    assert len(browser.find_elements("css selector", "#view-run canvas")) >= 4
    opened(browser, page, "#view=explorer&board=1&cost=file")
    assert browser.find_element("id", "front-text").text
    opened(browser, page, "#view=nowhere&board=99&sort=x")
    assert len(column(browser, "Model")) == 2


def test_the_keyboard_alone_sorts_and_opens_a_run(browser, page: str) -> None:
    from selenium.webdriver.common.keys import Keys

    opened(browser, page, "#board=1")
    browser.find_element("css selector", "[data-sort=backend]").send_keys(Keys.ENTER)
    focused = browser.switch_to.active_element
    assert focused.get_attribute("data-sort") == "backend"
    browser.find_element("css selector", "tbody a").send_keys(Keys.ENTER)
    time.sleep(0.2)
    assert "view=run" in browser.current_url


@pytest.mark.parametrize("width", [390, 1600])
def test_nothing_spills_over_the_page(browser, page: str, width: int) -> None:

    for part in ("#board=1", "#view=explorer&board=1", "#view=run&board=1&run=svm%2Ffp32"):
        opened(browser, page, part, width)
        inner, outer = browser.execute_script(
            "return [document.documentElement.scrollWidth, document.documentElement.clientWidth]"
        )
        assert inner <= outer + 1, part


def test_dark_and_light_and_no_error_in_the_console(browser, page: str) -> None:
    opened(browser, page, "#board=1")
    before = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    browser.find_element("id", "theme").click()
    after = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert before != after
    worst = [one for one in browser.get_log("browser") if one["level"] == "SEVERE"]
    assert worst == []


def test_every_control_has_a_name(browser, page: str) -> None:
    opened(browser, page, "#board=1")
    nameless = browser.execute_script(
        "return [...document.querySelectorAll('button,select,input,canvas')].filter((one) =>"
        " !(one.textContent.trim() || one.labels?.length || one.getAttribute('aria-label')))"
        ".map((one) => one.outerHTML)"
    )
    assert nameless == []
    assert browser.find_element("tag name", "html").get_attribute("lang") == "en"


@pytest.mark.parametrize(
    "part", ["#board=1", "#view=explorer&board=1", "#view=run&board=1&run=svm%2Ffp32"]
)
@pytest.mark.parametrize("dark", [False, True])
def test_an_accessibility_checker_finds_nothing_serious(
    browser, page: str, part: str, dark: bool
) -> None:
    from axe_core_python.selenium import Axe

    opened(browser, page, part)
    if dark:
        browser.find_element("id", "theme").click()
    found = Axe().run(browser)["violations"]
    grave = [one for one in found if one["impact"] in ("serious", "critical")]
    assert [(one["id"], one["nodes"][0]["html"]) for one in grave] == []
