# SPDX-License-Identifier: BSD-2-Clause
"""The manual's pages: figures are those of the scenario tables, links lead somewhere, and cited tests exist."""

import re
from pathlib import Path

import pytest

from tb.vectors import figures, load

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*(DOCS / "blocks").glob("*.md"), *(DOCS / "modules").glob("*.md"), DOCS / "timing.md", DOCS / "index.md"])
BLOCKS = {"quadrature", "snapshot", "trigger", "classifier", "compare", "divider", "router", "line", "pulse", "pwm", "interlock", "serial",
          "timer", "inputs", "buttons", "knob", "adc", "flash", "watchdog", "identity", "crossing", "bus", "led"}
HEADINGS = ["Pins", "How to use it", "Timing", "Limits and errors"]


def test_every_figure_is_up_to_date():
    for path, text in figures.files().items():
        assert path.read_text() == text, f"{path.name} is stale: python -m tb.vectors.figures"


def test_every_scenario_is_shown_under_its_name():
    shown = {(block, int(n)): name for page in PAGES
             for name, block, n in re.findall(r"!\[([^\]]*)\]\(../figures/(\w+)-(\d+)\.svg\)", page.read_text())}
    assert shown == {(block, n): scenario.name for block in figures.BLOCKS
                     for n, scenario in enumerate(load(block), 1)}


def test_every_block_has_its_page_in_the_fixed_order():
    assert {page.stem for page in (DOCS / "blocks").glob("*.md")} == BLOCKS
    for name in BLOCKS:
        headings = re.findall(r"^## (.*)", (DOCS / "blocks" / f"{name}.md").read_text(), re.MULTILINE)
        assert [h for h in headings if h in HEADINGS] == HEADINGS, name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_and_paths_lead_somewhere(page):
    text = page.read_text()
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        assert (page.parent / target).exists(), target
    for path in re.findall(r"`((?:rtl|soc|tb|firmware|host|docs)/[\w./]+)`", text):
        assert (ROOT / path).exists(), path
    for path in re.findall(r"`((?:hal|modules|core|servo)/[\w./]+)`", text):
        assert (ROOT / "firmware" / path).exists(), path


def cited(text):
    """Names in code spans of the columns "asserted by"."""
    column = None
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else None
        if cells is None:
            column = None
        elif column is None:
            column = cells.index("asserted by") if "asserted by" in cells else -1
        elif column >= 0:
            yield from re.findall(r"`(\w+)`", cells[column])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_test_cited_exists(page):
    sources = "\n".join(path.read_text() for ending in ("py", "c") for path in (ROOT / "tb").rglob(f"test_*.{ending}"))
    proofs = "\n".join(path.read_text() for path in (ROOT / "tb" / "formal").glob("*.py"))
    for name in cited(page.read_text()):
        proof = "".join(word.capitalize() for word in name.split("_"))
        assert (re.search(rf"\bdef {name}\(|\bTEST\({name}\)", sources)
                or re.search(rf"^class {proof}\(Proof\)", proofs, re.MULTILINE)), name


def test_pages_with_numbers_cite_tests():
    assert sum(len(set(cited(page.read_text()))) > 0 for page in PAGES) >= len(BLOCKS)
