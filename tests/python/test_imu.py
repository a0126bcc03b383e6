import subprocess

import numpy as np
import pytest

import delio


@pytest.fixture(scope="module")
def swung(tools, tmp_path_factory):
    """A VLP-16 in a hand, with an IMU, as a rawlog."""
    path = tmp_path_factory.mktemp("swung") / "drive.rawlog"
    words = "--scene indoor --scans 45 --sensor vlp16 --motion handheld --distort --imu 200"
    subprocess.run([tools / "synth2rawlog", "-o", path, *words.split()], check=True)
    return path


def with_imu(scans, add, process):
    """The steps of all scans, each after the samples that were read with it."""
    steps = []
    for scan in scans:
        for sample in scans.take_imu():
            add(sample)
        steps.append(process(scan))
    return steps


def test_the_gyroscope_gives_the_bytes_of_delio_slam(swung, tools, tmp_path):
    subprocess.run([tools / "delio-slam", "-i", swung, "-o", tmp_path / "slam", "--no-map"],
                   check=True)
    delio.run(swung, tmp_path / "run", build_map=False)
    scans = delio.open_scans(swung)
    odometry = delio.Odometry(recording=scans)
    with_imu(scans, odometry.add_imu, odometry.process)
    scans = delio.open_scans(swung)
    slam = delio.Slam(recording=scans, build_map=False)
    with_imu(scans, slam.add_imu, slam.process)
    delio.write_trajectory(tmp_path / "poses.txt", slam.finish().odometry_poses)
    expected = (tmp_path / "slam" / "trajectory_odometry_kitti.txt").read_bytes()
    assert (tmp_path / "run" / "trajectory_odometry_kitti.txt").read_bytes() == expected
    assert (tmp_path / "poses.txt").read_bytes() == expected
    for report in (odometry.imu_report, slam.imu_report):
        assert report.samples > 800 and report.scans_used > 20 and report.dropped == 0
        assert np.allclose(report.rotation @ report.rotation.T, np.eye(3), atol=1e-9)
        assert np.linalg.norm(report.bias) < np.radians(2) and report.findings == []


def test_run_without_the_imu(swung, tmp_path):
    delio.run(swung, tmp_path / "with", build_map=False, pictures=False)
    delio.run(swung, tmp_path / "without", build_map=False, pictures=False, imu=False)
    assert "imu:" in (tmp_path / "with" / "summary.yaml").read_text()
    assert "imu:" not in (tmp_path / "without" / "summary.yaml").read_text()


def test_samples(swung):
    scans = delio.open_scans(swung)
    next(scans)
    samples = scans.take_imu()
    assert np.all(np.diff([sample.stamp for sample in samples]) > 0)
    assert samples[0].rate.shape == (3,) and abs(samples[0].acceleration[2] - 9.8) < 3
    assert scans.take_imu() == []
    own = delio.ImuSample(1.5, [0.1, 0, 0])
    assert own.stamp == 1.5 and own.acceleration is None and own.sensor_pose is None
    assert np.array_equal(own.rate, [0.1, 0, 0])
    assert delio.Odometry().imu_report is None


@pytest.mark.parametrize("arguments, message", [
    ({"rate": np.zeros(2)}, r"'rate' must be an array of shape \(3,\), not .*\(2,\)"),
    ({"rate": "fast"}, "'rate' must be"),
    ({"rate": [0, 0, 0], "acceleration": 9.8}, "'acceleration' must be"),
    ({"rate": [0, 0, 0], "sensor_pose": np.zeros((4, 4))}, "'sensor_pose' must be a rigid"),
])
def test_wrong_samples(arguments, message):
    with pytest.raises(delio.Error, match=message):
        delio.ImuSample(0.0, **arguments)
