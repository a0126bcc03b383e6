"""Wheel odometry: it carries the pose through a smooth tunnel."""

import numpy as np
import pytest

import delio


@pytest.fixture(scope="module")
def tunnel(tmp_path_factory, tool):
    rawlog = tmp_path_factory.mktemp("wheels") / "tunnel.rawlog"
    tool(f"synth2rawlog -o {rawlog} --scene tunnel --scans 40 --sensor vlp16 --odometry 0")
    return rawlog
