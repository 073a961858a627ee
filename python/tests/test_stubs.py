"""The type stubs match the module."""

import runpy


def test_the_stubs_are_those_of_the_module(root):
    stubs = runpy.run_path(str(root / "python" / "stubs.py"))["stubs"]
    written = (root / "python" / "src" / "fga" / "_fga.pyi").read_text()
    assert stubs() == written, "python python/stubs.py > python/src/fga/_fga.pyi"
    compile(written, "_fga.pyi", "exec")
