"""Pages made from files outside docs/: notebooks, examples, CHANGELOG.md and CONTRIBUTING.md.

Links in docs/ name the file (`../notebooks/01_paper_experiment.ipynb`), as GitHub needs them; here
they become links to the page. mkdocs-jupyter is not used because it makes HTML by nbconvert, so
that links between notebooks and pages would be neither rewritten nor checked.
"""

from __future__ import annotations

import ast
import base64
import json
import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
EXAMPLES = "examples"
PAGES = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    EXAMPLES: "examples.md",
    **{
        f"notebooks/{path.name}": f"notebooks/{path.stem}.md"
        for path in sorted((ROOT / "notebooks").glob("*.ipynb"))
    },
}
"""Files and folders of the repository, relative to its root, and the page made of each."""
_LINK = re.compile(r"\]\((?P<path>[\w./-]+)(?P<anchor>#[\w-]+)?\)")


def on_files(files: Files, config: Any) -> Files:
    """Add the pages, and the pictures of the notebooks."""
    for source, target in PAGES.items():
        if source == EXAMPLES:
            text = examples_page(sorted((ROOT / EXAMPLES).glob("*.py")))
        else:
            text = (ROOT / source).read_text(encoding="utf-8")
        if source.endswith(".ipynb"):
            text, pictures = notebook_page(json.loads(text), Path(source).stem)
            for name, content in pictures.items():
                files.append(File.generated(config, f"notebooks/{name}", content=content))
        files.append(File.generated(config, target, content=text))
    return files


def on_page_markdown(text: str, page: Any, **_: Any) -> str:
    """Replace links to files outside docs/ by links to their pages."""
    address = page.file.src_uri
    source = next((s for s, target in PAGES.items() if target == address), f"docs/{address}")

    def rewritten(link: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(source), link["path"]))
        if target not in PAGES and not (target.startswith("docs/") and source in PAGES):
            return link[0]
        page_of_target = PAGES.get(target, target.removeprefix("docs/"))
        relative = posixpath.relpath(page_of_target, posixpath.dirname(address) or ".")
        return f"]({relative}{link['anchor'] or ''})"

    return _LINK.sub(rewritten, text)


def examples_page(scripts: list[Path]) -> str:
    """Markdown page of scripts: for each its docstring, its first line as title, and its code."""
    parts = [
        "# Examples",
        "The scripts in the folder `examples`. Run one with `.venv/bin/python examples/NAME.py`.",
    ]
    for script in scripts:
        source = script.read_text(encoding="utf-8")
        module = ast.parse(source)
        title, _, text = (ast.get_docstring(module) or script.stem).partition("\n")
        code = "\n".join(source.splitlines()[module.body[0].end_lineno :]).strip()
        parts += [f"## {title.strip().rstrip('.')}", f"`examples/{script.name}`", text.strip()]
        parts.append(f"```python\n{code}\n```")
    return "\n\n".join(filter(None, parts)) + "\n"


def notebook_page(notebook: dict[str, Any], name: str) -> tuple[str, dict[str, bytes]]:
    """Markdown page of a notebook with its stored outputs, and the files that it shows by name."""
    parts: list[str] = []
    shown: dict[str, bytes] = {}
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        for output in cell["outputs"]:
            data = output.get("data", {})
            kind = next((k for k in ("image/png", "image/gif", "text/html") if k in data), "")
            file = f"{name}_{len(shown) + 1}.{kind.split('/')[-1]}"
            if kind == "text/html":
                shown[file] = "".join(data[kind]).encode()
                parts.append(f'<iframe class="output" loading="lazy" src="{file}"></iframe>')
            elif kind:
                shown[file] = base64.b64decode("".join(data[kind]))
                parts.append(f"![Output]({file})")
            else:
                text = "".join(output.get("text", data.get("text/plain", "")))
                parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts) + "\n", shown
