import subprocess

import numpy as np
import pytest

import delio


@pytest.fixture(scope="module")
def tunnel(tools, tmp_path_factory):
    """A VLP-16 on a car in a smooth tunnel, with wheel odometry, as a rawlog."""
    path = tmp_path_factory.mktemp("tunnel") / "drive.rawlog"
    words = "--scene tunnel --scans 40 --sensor vlp16 --seed 7 --start moving --odometry 0"
    subprocess.run([tools / "synth2rawlog", "-o", path, *words.split()], check=True)
    return path


def test_wheels_carry_the_pose_as_in_delio_slam(tunnel, tmp_path):
    delio.run(tunnel, tmp_path / "run", build_map=False, pictures=False)
    with pytest.raises(delio.Error, match="not to be relied on"):
        delio.run(tunnel, tmp_path / "without", build_map=False, pictures=False, odometry=False)
    assert "odometry:" in (tmp_path / "run" / "summary.yaml").read_text()
    assert "odometry:" not in (tmp_path / "without" / "summary.yaml").read_text()
    scans = delio.open_scans(tunnel)
    slam = delio.Slam(recording=scans, build_map=False)
    for scan in scans:
        for sample in scans.take_odometry():
            slam.add_odometry(sample)
        slam.process(scan)
    delio.write_trajectory(tmp_path / "poses.txt", slam.finish().odometry_poses)
    expected = (tmp_path / "run" / "trajectory_odometry_kitti.txt").read_bytes()
    assert (tmp_path / "poses.txt").read_bytes() == expected
    report = slam.odometry_report
    assert report.scans_carried > 35 and report.dropped == report.jumps == 0
    assert report.sigma is None and report.scale == 1 and report.findings == []


def test_samples():
    pose = np.eye(4)
    pose[0, 3] = 2
    sample = delio.OdometrySample(1.5, pose)
    assert sample.stamp == 1.5 and np.array_equal(sample.pose, pose)
    assert sample.sensor_pose is None
    assert delio.Odometry().odometry_report is None
    with pytest.raises(delio.Error, match="pose"):
        delio.OdometrySample(0.0, np.eye(3))
