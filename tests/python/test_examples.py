"""Every example of share/examples/python, as its user runs it."""

import pathlib
import re
import subprocess
import sys

import pytest

EXAMPLES = pathlib.Path(__file__).parents[2] / "share" / "examples" / "python"


def run(name, *arguments):
    done = subprocess.run([sys.executable, EXAMPLES / name, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def assert_picture(path):
    assert path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 8000


def test_trajectory(drive, results, tmp_path):
    text = run("01_trajectory.py", drive, tmp_path / "poses.txt")
    assert text.startswith("20 scans, ")
    odometry = results / "trajectory_odometry_kitti.txt"
    assert (tmp_path / "poses.txt").read_bytes() == odometry.read_bytes()


def test_own_sensor(tmp_path):
    text = run("02_own_sensor.py", tmp_path / "map.png")
    found = re.fullmatch(r"path (\S+) m, error (\S+) m\n", text)
    assert found and abs(float(found[1]) - 1.8) < 0.01 and float(found[2]) < 0.01, text
    assert_picture(tmp_path / "map.png")


def test_localise(drive, results, tmp_path):
    text = run("03_localise.py", results, drive, tmp_path / "way.png")
    assert text.count(" in_map ") >= 15, text
    assert_picture(tmp_path / "way.png")


def test_compare(drive, results, tmp_path):
    odometry = results / "trajectory_kitti_cam0.txt"
    text = run("04_compare.py", tmp_path / "both.png", drive / "poses.txt", f"slam={results}",
               f"same={odometry}")
    lines = text.splitlines()
    assert len(lines) == 2 and lines[0][5:] == lines[1][5:] and re.search(r"APE 0\.0\d+ m", text), text
    assert_picture(tmp_path / "both.png")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_examples_are_short(path):
    assert len(path.read_text().splitlines()) < 60
