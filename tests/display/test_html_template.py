"""Pages: whatever a text holds, it stays inside the script that it is written into."""

import json
from html.parser import HTMLParser

import pytest

from ffsr_plan.display.web.html_template import html_page, script_literal

HOSTILE = (
    "</script><script>alert(1)</script>",
    "<!--<script>",
    "<!-- <script> </script> -->",
    "-->",
    "]]>&amp;&lt;",
    "line\u2028and\u2029paragraph",
    "half \ud800 of a pair",
    "/*DATA*/ <!--PANELS-->",
    "\\u003c \\",
)


class Structure(HTMLParser):
    """Tags of a page in order, with the texts of its scripts."""

    def __init__(self):
        super().__init__(convert_charrefs=False)
        self.tags, self.scripts, self.comments = [], [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag):
        self.tags.append(f"/{tag}")

    def handle_data(self, text):
        if self.tags and self.tags[-1] == "script":
            self.scripts[-1] += text

    def handle_comment(self, text):
        self.comments.append(text)


def structure(page):
    parser = Structure()
    parser.feed(page)
    parser.close()
    return parser


@pytest.mark.parametrize("name", ["plan", "live"])
@pytest.mark.parametrize("title", HOSTILE)
def test_a_title_does_not_change_the_structure_of_a_page(name, title):
    data = {"title": title, "commands": [title]}
    plain, page = structure(html_page(name, {"title": "x"})), structure(html_page(name, data))
    assert page.tags == plain.tags
    assert page.comments == plain.comments
    script = page.scripts[-1]
    literal = script[script.index("const data = ") + 13 : script.index(";\n", 20)]
    assert json.loads(literal) == data


def test_nothing_in_a_script_opens_or_closes_an_html_element():
    for text in HOSTILE:
        literal = script_literal({"title": text})
        assert not set(literal) & set("<>&\u2028\u2029")
        assert json.loads(literal) == {"title": text}
        literal.encode()


def test_no_script_of_a_page_holds_what_the_parser_of_browsers_nests():
    scripts = structure(html_page("plan", {"title": "<!--<script>"})).scripts
    assert len(scripts) == 2
    assert not [script for script in scripts if "<!--" in script or "<script" in script.lower()]
