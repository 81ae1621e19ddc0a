"""Pages of the site that are not kept in docs/: notebooks as they were last run, and the project's.

Links to them in docs/ name the file itself (`../notebooks/01_paper_experiment.ipynb`), which is
right on GitHub; here they are turned into links to the page.
"""

from __future__ import annotations

import base64
import json
import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
PAGES = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    **{
        f"notebooks/{path.name}": f"notebooks/{path.stem}.md"
        for path in sorted((ROOT / "notebooks").glob("*.ipynb"))
    },
}
"""Files of the repository, from its root, and the pages made of them."""
_LINK = re.compile(r"\]\((?P<path>[\w./-]+)(?P<anchor>#[\w-]+)?\)")


def on_files(files: Files, config: Any) -> Files:
    """Add the pages, and the pictures of the notebooks."""
    for source, target in PAGES.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        if source.endswith(".ipynb"):
            text, pictures = notebook_page(json.loads(text), Path(source).stem)
            for name, content in pictures.items():
                files.append(File.generated(config, f"notebooks/{name}", content=content))
        files.append(File.generated(config, target, content=text))
    return files


def on_page_markdown(text: str, page: Any, **_: Any) -> str:
    """Turn links to files outside docs/ into links to their pages."""
    here = page.file.src_uri
    source = next((s for s, target in PAGES.items() if target == here), f"docs/{here}")

    def moved(found: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(source), found["path"]))
        if target not in PAGES and not (target.startswith("docs/") and source in PAGES):
            return found[0]
        to = PAGES.get(target, target.removeprefix("docs/"))
        relative = posixpath.relpath(to, posixpath.dirname(here) or ".")
        return f"]({relative}{found['anchor'] or ''})"

    return _LINK.sub(moved, text)


def notebook_page(notebook: dict[str, Any], name: str) -> tuple[str, dict[str, bytes]]:
    """A notebook with its stored outputs as Markdown, and the files that go beside it."""
    parts: list[str] = []
    beside: dict[str, bytes] = {}
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        for output in cell["outputs"]:
            data = output.get("data", {})
            kind = next((k for k in ("image/png", "image/gif", "text/html") if k in data), "")
            file = f"{name}_{len(beside) + 1}.{kind.split('/')[-1]}"
            if kind == "text/html":
                beside[file] = "".join(data[kind]).encode()
                parts.append(f'<iframe class="output" loading="lazy" src="{file}"></iframe>')
            elif kind:
                beside[file] = base64.b64decode("".join(data[kind]))
                parts.append(f"![Output]({file})")
            else:
                text = "".join(output.get("text", data.get("text/plain", "")))
                parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts) + "\n", beside
