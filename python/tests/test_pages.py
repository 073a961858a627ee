"""The examples of the pages run as they stand, from the root of the repository."""

import re

import pytest
from conftest import ROOT, needed

PAGES = ["README.md", "python/README.md", "docs/reference-python.md", "docs/own-policy.md"]
EXAMPLES = [
    pytest.param(code, id=f"{page}-{number}")
    for page in PAGES
    for number, code in enumerate(re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL))
]


def test_every_page_has_an_example():
    assert len(EXAMPLES) >= len(PAGES)


@pytest.mark.parametrize("code", EXAMPLES)
def test_an_example_runs(code, root, monkeypatch, capsys):
    if "polars" in code:
        needed("polars")
    monkeypatch.chdir(root)
    exec(compile(code, "example", "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out
