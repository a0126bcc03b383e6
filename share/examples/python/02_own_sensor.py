#!/usr/bin/python3
"""A sensor without a reader in DeLiO: arrays in, poses and a map out. The driver here simulates a
32-ring LiDAR that drives and turns in a hall. 02_own_sensor.py [MAP.png]"""
import sys

import numpy as np

import delio

LOW, HIGH = np.array([-15.4, -9.4, -1.7]), np.array([17.3, 11.3, 6.3])  # the hall, metres


def poses_at(time):
    """Poses (N, 4, 4) of the sensor in the hall: 2 m/s forward, 1 rad/s to the left."""
    pose = np.tile(np.eye(4), (len(time), 1, 1))
    pose[:, 0, 0] = pose[:, 1, 1] = np.cos(time)
    pose[:, 1, 0], pose[:, 0, 1] = np.sin(time), -np.sin(time)
    pose[:, 0, 3], pose[:, 1, 3] = 2 * np.sin(time), 2 * (1 - np.cos(time))
    return pose


def scan_at(stamp):
    """One turn of the sensor, 0.1 s, stamped in its middle: points, times and rings."""
    column, rings = [index.ravel() for index in np.mgrid[0:1000, 0:32]]
    azimuth, up = 2 * np.pi * column / 1000, np.radians(10 - 1.1 * rings)
    rays = np.stack([np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up)], 1)
    times = 0.1 * (column / 1000 - 0.5)  # seconds from the stamp
    pose = poses_at(stamp + times)
    ahead = np.einsum("nij,nj->ni", pose[:, :3, :3], rays)
    ranges = np.abs((np.where(ahead > 0, HIGH, LOW) - pose[:, :3, 3]) / ahead).min(axis=1)
    return rays * ranges[:, None], times, rings


slam = delio.Slam()
for stamp in np.arange(10) * 0.1:
    points, times, rings = scan_at(stamp)
    step = slam.process(points, stamp, times=times, rings=rings)
    if step.state != "tracked" and stamp > 0:
        print(f"{stamp:.1f} s: {step.state}: {step.reason}")
result = slam.finish()
error = np.linalg.inv(poses_at(np.array([0.9]))[0]) @ result.poses[-1]
print(f"path {result.path_m:.3f} m, error {np.linalg.norm(error[:3, 3]):.4f} m")

if len(sys.argv) > 1:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    cloud = slam.cloud()
    plt.figure(figsize=(6, 4))
    plt.scatter(cloud[:, 0], cloud[:, 1], c=cloud[:, 2], s=1)
    plt.plot(result.poses[:, 0, 3], result.poses[:, 1, 3], "r", linewidth=2)
    plt.axis("equal")
    plt.xlabel("x [m]")
    plt.ylabel("y [m]")
    plt.colorbar(label="z [m]")
    plt.savefig(sys.argv[1], dpi=80, bbox_inches="tight")
