"""delio.evalio beside a stand-in of evalio's base class."""

import pathlib
import sys

import numpy as np
import pytest

import delio

sys.path.insert(0, str(pathlib.Path(__file__).parent / "evalio_stand_in"))
from evalio import types  # noqa: E402

from delio.evalio import DeLiO  # noqa: E402

IMU_T_LIDAR = np.array([[0.0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]])


def measurement(scan):
    """As evalio has it: in nanoseconds since the scan's begin, zeros for no return."""
    nsec = round(scan.stamp * 1e9)
    points = [types.Point(*point, t=types.Duration(i % 100)) for i, point in
              enumerate(scan.points.astype(float).tolist())]
    return types.LidarMeasurement(types.Stamp(nsec // 10**9, nsec % 10**9), [types.Point()] + points)


def started(visualizing=None, **params):
    """In evalio's order."""
    pipe = DeLiO()
    assert pipe.set_params({**DeLiO.default_params(), **params, "unknown": 1}) == {"unknown": 1}
    pipe.set_imu_params(None)
    pipe.set_lidar_params(None)
    pipe.set_imu_T_lidar(types.SE3(IMU_T_LIDAR))
    pipe.initialize()
    pipe.set_visualizing(visualizing)
    return pipe


def test_pipeline_gives_the_poses_of_the_imu(drive):
    pipe, odometry = started(), delio.Odometry()
    assert pipe.name() == "delio" and pipe.version() == delio.__version__
    assert pipe.map() == {"point": []}
    for scan, _ in zip(delio.open_scans(drive), range(5)):
        pipe.add_imu(None)
        taken = measurement(scan)
        pipe.add_lidar(taken)
        (stamp, pose), = pipe.saved_estimates()  # at once: evalio asks after each scan
        times = np.arange(len(scan)) % 100 * 1e-9
        step = odometry.process(scan.points.astype(float), taken.stamp.to_sec(), times=times)
        assert stamp == taken.stamp
        assert np.allclose(pose.to_mat(), step.pose @ np.linalg.inv(IMU_T_LIDAR), atol=1e-9)
        assert pipe.saved_features() == []


def test_pipeline_shows_points_where_they_are_asked_for(drive):
    pipe = started(visualizing=set(), max_range=20.0)
    pipe.add_lidar(measurement(next(delio.open_scans(drive))))
    (_, features), = pipe.saved_features()
    ranges = [np.linalg.norm([point.x, point.y, point.z]) for point in features["point"]]
    assert 100 < len(ranges) and max(ranges) <= 20


def test_wrong_parameters_are_errors():
    with pytest.raises(delio.Error, match="unknown profile"):
        started(profile="best")
