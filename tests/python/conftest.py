"""A small synthetic drive that all tests share, made by DeLiO's programs (DELIO_TOOLS)."""

import os
import pathlib
import subprocess

import pytest


@pytest.fixture(scope="session")
def tools():
    """Folder of DeLiO's programs."""
    return pathlib.Path(os.environ["DELIO_TOOLS"])


@pytest.fixture(scope="session")
def drive(tools, tmp_path_factory):
    """Twenty scans of a street in KITTI's layout, with ground truth."""
    folder = tmp_path_factory.mktemp("drive")
    rawlog = folder / "drive.rawlog"
    words = "--scene urban --scans 20 --sensor hdl32e --start moving".split()
    subprocess.run([tools / "synth2rawlog", "-o", rawlog, *words], check=True)
    subprocess.run([tools / "rawlog2kitti", "-i", rawlog, "-o", folder / "kitti"], check=True)
    return folder / "kitti"


@pytest.fixture(scope="session")
def results(tools, drive, tmp_path_factory):
    """The results of delio-slam."""
    folder = tmp_path_factory.mktemp("results") / "slam"
    subprocess.run([tools / "delio-slam", "-i", drive, "-o", folder], check=True)
    return folder
