#!/usr/bin/python3
"""Localises a vehicle in the map of another drive, without an initial guess, and draws where it is:
03_localise.py MAP_FOLDER RECORDING OUT.png"""
import sys

import matplotlib
import numpy as np

import delio

matplotlib.use("Agg")
import matplotlib.pyplot as plt

folder, recording, picture = sys.argv[1:]
stored = delio.StoredMap(folder)
scans = delio.open_scans(recording)
localiser = delio.Localiser(stored, recording=scans)
found = []
for scan in scans:
    result = localiser.process(scan)
    if result.pose is None or result.covariance is None:
        print(f"{scan.index}: not found yet")
        continue
    x, y, z = result.pose[:3, 3]
    sigma = np.sqrt(np.trace(result.covariance[:3, :3]))
    print(f"{scan.index}: {result.where} {x:.3f} {y:.3f} {z:.3f} +- {sigma:.3f} m")
    found.append(result.pose[:3, 3])
if not found:
    sys.exit("the vehicle was not found in the map")

cloud, way = stored.cloud(0.3), np.array(found)
plt.figure(figsize=(6, 4))
plt.scatter(cloud[:, 0], cloud[:, 1], c=cloud[:, 2], s=0.5, cmap="gray")
plt.plot(way[:, 0], way[:, 1], "r.-", label="localised")
plt.axis("equal")
plt.xlabel("x [m]")
plt.ylabel("y [m]")
plt.legend()
plt.savefig(picture, dpi=100, bbox_inches="tight")
