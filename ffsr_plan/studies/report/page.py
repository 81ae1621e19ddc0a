"""The page of a study: its tables and pictures in one file that needs no network."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

from ffsr_plan.studies.report.tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #1d2a3a; max-width: 1080px;
  margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }
th, td { padding: .3rem .7rem; border-bottom: 1px solid #d8dee6; text-align: right; }
th { background: #eef3f8; font-weight: 600; } .text { text-align: left; }
svg { max-width: 100%; height: auto; } p.note, figcaption { color: #52657a; }
figure { margin: 1.5rem 0; } figcaption { font-size: 13px; max-width: 46rem; }
"""


def page(
    title: str, sentences: Sequence[str], tables: Sequence[Table], figures: Mapping[str, Figure]
) -> str:
    """The text of the page.

    Args:
        title: of the study.
        sentences: below the title.
        tables: of the study.
        figures: pictures by name, in their order; their labels are captions.
    """
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{escape(title)}</h1>",
        *(f'<p class="note">{escape(sentence)}</p>' for sentence in sentences),
        *(_table(table) for table in tables[:1]),
        *(_captioned(figure) for figure in figures.values()),
        *(_table(table) for table in tables[1:]),
        "</body></html>\n",
    ]
    return "\n".join(parts)


def _table(table: Table) -> str:
    def row(tag: str, cells: Sequence[str]) -> str:
        shown = (
            f"<{tag}{' class=text' if k < table.texts else ''}>{escape(cell)}</{tag}>"
            for k, cell in enumerate(cells)
        )
        return f"<tr>{''.join(shown)}</tr>"

    rows = "\n".join(row("td", cells) for cells in table.rows)
    head = row("th", table.headings)
    return f'<h2>{escape(table.title)}</h2><div class="table"><table>{head}{rows}</table></div>'


def _captioned(figure: Figure) -> str:
    caption = escape(str(figure.get_label() or ""))
    return f"<figure>{svg(figure)}<figcaption>{caption}</figcaption></figure>"


def svg(figure: Figure) -> str:
    """A picture as an element of a page.

    Args:
        figure: the picture.
    """
    import matplotlib

    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "ffsr-plan", "svg.fonttype": "path"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()[text.getvalue().index("<svg") :]
