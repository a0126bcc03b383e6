import subprocess

import numpy as np
import pytest

import delio


def path_of(scale=1.0, count=400):
    """Poses along a bend, a metre each."""
    poses = np.tile(np.eye(4), (count, 1, 1))
    angle = np.arange(count) * 0.001
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angle)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 0, 3], poses[:, 1, 3] = 1000 * scale * np.sin(angle), 1000 * scale * (1 - np.cos(angle))
    return poses


def test_evaluate_gives_the_numbers_of_delio_eval(tools, drive, results):
    text = subprocess.run([tools / "delio-eval", "-r", drive / "poses.txt", "-e", results, "-f", "tsv",
                           "-l", "5,10"], check=True, capture_output=True, text=True).stdout
    names, values = [line.split("\t") for line in text.splitlines()]
    told = dict(zip(names, values))
    found = delio.evaluate(drive / "poses.txt", results, lengths=[5, 10])
    for name, value in {"t_percent": found.translation_percent, "ape_m": found.ape_m,
                        "r_deg_per_100m": found.rotation_deg_per_100m, "rpe_m": found.rpe_m,
                        "rpe_deg": found.rpe_deg, "segments": found.segments,
                        "length_m": found.length_m}.items():
        assert float(told[name]) == pytest.approx(value, rel=1e-3), name
    assert set(found.per_length) == {5.0, 10.0}


def test_evaluate_finds_a_wrong_scale():
    found = delio.evaluate(path_of(), path_of(1.01), lengths=[100, 200])
    assert found.translation_percent == pytest.approx(1, rel=0.02)
    assert found.rotation_deg_per_100m == pytest.approx(0, abs=1e-9)
    assert found.step_errors_m.shape == (399,) and found.step_errors_m == pytest.approx(0.01, rel=0.01)
    assert found.reference.shape == found.estimate.shape == (400, 4, 4)
    assert delio.evaluate(path_of(), path_of(1.01), delta=10).rpe_m == pytest.approx(0.1, rel=0.01)


def test_poses_with_stamps_are_matched_by_time():
    poses, stamps = path_of(), np.arange(400) * 0.1
    found = delio.evaluate((poses, stamps), (poses[::2], stamps[::2] + 0.001))
    assert len(found.estimate) == 200 and found.ape_m == pytest.approx(0, abs=1e-9)
    assert "200 of the reference have no counterpart" in found.warnings[0]


def test_calibration_brings_the_estimate_to_the_camera(drive, results):
    tr = delio.open_scans(drive).calibration
    lidar, cam0 = results / "trajectory_kitti.txt", results / "trajectory_kitti_cam0.txt"
    assert delio.evaluate(cam0, lidar, calibration=tr).ape_m < 1e-6
    with pytest.raises(delio.Error, match="frame"):
        delio.evaluate(cam0, lidar)


@pytest.mark.parametrize("estimate, message", [
    (np.eye(4), "'estimate' must be a path, poses of shape (N, 4, 4), or a pair"),
    (5, "'estimate' must be a path"),
    (2 * path_of(), "must be a rigid motion"),
    ((path_of(), np.zeros(3)), "must have stamps of shape (400,)"),
    ((path_of(), np.zeros(400)), "stamps that increase"),
    ("/nowhere.txt", "/nowhere.txt"),
    (path_of()[:100], "100"),
])
def test_wrong_trajectories_are_errors(estimate, message):
    with pytest.raises(delio.Error) as caught:
        delio.evaluate(path_of(), estimate)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_trajectory_files_keep_every_bit(tmp_path):
    poses, stamps = path_of(), np.arange(400) * 0.1 + 1.7e9
    delio.write_trajectory(tmp_path / "kitti.txt", poses)
    back, none = delio.read_trajectory(tmp_path / "kitti.txt")
    assert np.allclose(back, poses, atol=1e-12) and none is None
    delio.write_trajectory(tmp_path / "tum.txt", poses, stamps)
    back, times = delio.read_trajectory(tmp_path / "tum.txt")
    assert np.allclose(back, poses, atol=1e-6) and np.allclose(times, stamps, atol=1e-6)


def test_align_finds_the_motion_between_scans(drive, results):
    scans = list(delio.open_scans(drive))
    poses, _ = delio.read_trajectory(results / "trajectory_kitti.txt")
    truth = np.linalg.inv(poses[2]) @ poses[5]
    for guess in (None, truth):
        found = delio.align(scans[2].points, scans[5].points.astype(np.float64), guess)
        error = np.linalg.inv(truth) @ found.pose
        assert np.linalg.norm(error[:3, 3]) < 0.05
        assert 0.5 < found.inlier_ratio <= 1 and 0 < found.agreement <= 1 and found.residual < 0.2
        assert np.linalg.eigvalsh(found.covariance).min() > 0
    # The tangent's axes turn with the second cloud.
    turn = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    turned = delio.align(scans[2].points, scans[5].points @ turn[:3, :3].astype(np.float32), truth @ turn)
    J = np.kron(np.eye(2), turn[:3, :3].T)
    assert np.allclose(turned.covariance, J @ found.covariance @ J.T, rtol=0.5,
                       atol=0.3 * np.abs(found.covariance).max())


def test_align_refuses_clouds_without_surfaces():
    with pytest.raises(delio.Error, match="no planes"):
        delio.align(np.zeros((500, 3)), np.zeros((500, 3)))
    with pytest.raises(delio.Error, match="'second' must be a float32 or float64 array"):
        delio.align(np.zeros((500, 3)), np.zeros(3))
