"""The code of share/doc/method/python.md, block after block."""

import pathlib
import re

PAGE = pathlib.Path(__file__).parents[2] / "share" / "doc" / "method" / "python.md"


def test_code_of_the_page(drive, tmp_path, monkeypatch, capsys):
    (tmp_path / "kitti").symlink_to(drive)
    monkeypatch.chdir(tmp_path)
    names = {}
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) == 8
    for block in blocks:
        exec(compile(block, PAGE.name, "exec"), names)
    assert capsys.readouterr().out.count("\n") > 15
    assert len((tmp_path / "poses.txt").read_text().splitlines()) == 20
