#!/usr/bin/python3
"""A recording in, its trajectory out: 01_trajectory.py RECORDING OUT.txt"""
import sys

import numpy as np

import delio

recording, out = sys.argv[1:]
scans = delio.open_scans(recording)
odometry = delio.Odometry(recording=scans)
poses = [odometry.process(scan).pose for scan in scans]
delio.write_trajectory(out, np.array(poses))
print(f"{len(poses)} scans, {scans.description}")
