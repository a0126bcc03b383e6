#!/usr/bin/python3
"""Compares programs with a reference and draws their trajectories and errors:
04_compare.py OUT.png REFERENCE NAME=ESTIMATE... (pose files, or folders of delio-slam)"""
import sys

import matplotlib
import numpy as np

import delio

matplotlib.use("Agg")
import matplotlib.pyplot as plt

picture, reference, *estimates = sys.argv[1:]
figure, (above, errors) = plt.subplots(1, 2, figsize=(9, 4))
for number, text in enumerate(estimates):
    name, path = text.split("=", 1)
    metrics = delio.evaluate(reference, path)
    print(f"{name}: {metrics.translation_percent:.3f} %, {metrics.rotation_deg_per_100m:.3f} deg/100 m, "
          f"APE {metrics.ape_m:.3f} m, RPE {metrics.rpe_m:.4f} m {metrics.rpe_deg:.4f} deg")
    for poses, label, style in ((metrics.reference, "reference", "k--"), (metrics.estimate, name, "-")):
        if number > 0 and label == "reference":
            continue
        # Relative to the first pose; the two axes along which it moves most.
        way = (np.linalg.inv(poses[0]) @ poses)[:, :3, 3]
        across, ahead = sorted(np.argsort(np.ptp(metrics.reference[:, :3, 3], axis=0))[1:])
        above.plot(way[:, across], way[:, ahead], style, label=label)
    errors.plot(np.sort(metrics.step_errors_m) * 1000, np.linspace(0, 1, len(metrics.step_errors_m)), label=name)
above.axis("equal")
above.set_xlabel("m")
above.set_ylabel("m")
above.legend()
errors.set_xlabel("error of a step [mm]")
errors.set_ylabel("fraction of the steps")
errors.legend()
figure.savefig(picture, dpi=100, bbox_inches="tight")
