"""The documentation site: built without warnings, complete, and independent of the network."""

import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pytest

import ffsr_plan as fp
from tests.helpers.documentation_pages import ROOT

pytest.importorskip("mkdocs", reason="the extra 'docs' is not installed")
pytestmark = pytest.mark.slow

VERBATIM = ("code", "script", "style")
# elements that make a browser load a file, and the attribute with its address
LOADED = {"script": "src", "img": "src", "iframe": "src", "link": "href"}


class Page(HTMLParser):
    """Links, loaded files and anchors of a page; number of equations and of unconverted ones."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.anchors = [], [], set()
        self.equations = self.unfinished = 0
        self._code = 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_data(self, data):
        self.unfinished += "$" in data and not self._code

    def handle_endtag(self, tag):
        self._code -= tag in VERBATIM

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self._code += tag in VERBATIM
        self.anchors.add(given.get("id"))
        self.equations += tag == "math"
        self.unfinished += "arithmatex" in (given.get("class") or "")
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if given.get(LOADED.get(tag)) and given.get("rel") != "canonical":
            self.loaded.append(given[LOADED[tag]])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The site, built with every warning an error."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def site(folder):
    """Pages by address."""
    return {path.relative_to(folder).as_posix(): Page(path) for path in folder.rglob("*.html")}


def test_nothing_is_loaded_from_the_network(site):
    addresses = [a for page in site.values() for a in page.loaded]
    assert addresses
    assert not [a for a in addresses if re.match(r"(https?:)?//", a)]


def test_style_sheets_load_nothing_from_the_network(folder):
    sheets = list(folder.rglob("*.css"))
    assert sheets
    for sheet in sheets:
        assert not re.search(r"(url\(|@import)\s*[\"']?(https?:)?//", sheet.read_text()), sheet
    assert (folder / "STIXTwoMath-Regular.ttf").stat().st_size > 100_000


def test_links_inside_the_site_and_their_anchors_exist(site):
    for name, page in site.items():
        if name == "404.html":  # its links are from the root of a server
            continue
        for link in page.links:
            address, anchor = urldefrag(link)
            if re.match(r"\w+:", address) or link.startswith("#__"):
                continue
            folder = Path("/") / Path(name).parent
            target = name if not address else (folder / unquote(address)).resolve()
            target = str(target).lstrip("/")
            if target.endswith(".html"):
                assert target in site, (name, link)
                assert not anchor or anchor in site[target].anchors, (name, link)


def test_every_public_name_has_an_entry(site):
    anchors = {a for name, page in site.items() if name.startswith("api/") for a in page.anchors}
    assert {f"ffsr_plan.{name}" for name in fp.__all__} <= anchors


def test_notebooks_show_their_stored_outputs(site):
    notebooks = sorted((ROOT / "notebooks").glob("*.ipynb"))
    assert notebooks
    for path in notebooks:
        cells = json.loads(path.read_text())["cells"]
        shown = [set(o.get("data", {})) for cell in cells for o in cell.get("outputs", [])]
        loaded = site[f"notebooks/{path.stem}.html"].loaded
        for kind, ending in {"image/png": ".png", "text/html": ".html"}.items():
            assert sum(kind in data for data in shown) == sum(
                address.startswith(path.stem) and address.endswith(ending) for address in loaded
            )


def test_every_example_is_on_the_page_of_examples(folder):
    page = (folder / "examples.html").read_text(encoding="utf-8")
    for script in (ROOT / "examples").glob("*.py"):
        assert f"examples/{script.name}" in page


def test_equations_are_drawn_without_a_script(site):
    for name, least in {"proof": 200, "physics": 20, "paper": 10}.items():
        assert site[f"{name}.html"].equations >= least
    assert not [name for name, page in site.items() if page.unfinished]
