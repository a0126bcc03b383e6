import subprocess
import sys
import threading

import numpy as np
import pytest

import delio


def odometry_bytes(scans, process, path):
    """The trajectory file of the poses that process(scan) gives."""
    delio.write_trajectory(path, np.array([process(scan).pose for scan in scans]))
    return path.read_bytes()


def test_scans_give_the_bytes_of_delio_slam(drive, results, tmp_path):
    scans = delio.open_scans(drive)
    odometry = delio.Odometry(recording=scans)
    found = odometry_bytes(scans, odometry.process, tmp_path / "poses.txt")
    assert found == (results / "trajectory_odometry_kitti.txt").read_bytes()


@pytest.mark.parametrize("layout", ["float32", "float64", "fortran", "columns", "reversed"])
def test_arrays_give_the_bytes_of_delio_slam(drive, results, tmp_path, layout):
    def laid_out(points):
        if layout == "fortran":
            return np.asfortranarray(points)
        if layout == "columns":
            return np.hstack([points, points])[:, :3]
        if layout == "reversed":
            return np.ascontiguousarray(points[::-1])[::-1]
        return points.astype(layout)

    scans = delio.open_scans(drive)
    odometry = delio.Odometry(recording=scans)

    def process(scan):
        return odometry.process(laid_out(scan.points), scan.stamp, times=scan.times,
                                rings=scan.rings, intensity=scan.intensity,
                                sensor_pose=scan.sensor_pose)

    found = odometry_bytes(scans, process, tmp_path / "poses.txt")
    assert found == (results / "trajectory_odometry_kitti.txt").read_bytes()


def test_any_number_of_threads_gives_the_same_bytes(drive, results, tmp_path):
    delio.set_threads(1)
    scans = delio.open_scans(drive)
    odometry = delio.Odometry(recording=scans)
    found = odometry_bytes(scans, odometry.process, tmp_path / "poses.txt")
    delio.set_threads(0)
    assert found == (results / "trajectory_odometry_kitti.txt").read_bytes()


def test_one_thread_is_one_thread(drive):
    """No thread is added to those that Python and numpy have."""
    program = """if True:
        import os, sys, delio
        threads = lambda: len(os.listdir("/proc/self/task"))
        delio.set_threads(1)
        before, odometry = threads(), delio.Odometry()
        for scan in delio.open_scans(sys.argv[1]):
            odometry.process(scan)
        sys.exit(threads() != before)"""
    assert subprocess.run([sys.executable, "-c", program, drive]).returncode == 0


def test_step(drive):
    odometry = delio.Odometry()
    scans = list(delio.open_scans(drive))
    first, *others = [odometry.process(scan) for scan in scans]
    assert np.array_equal(first.pose, np.eye(4)) and np.array_equal(first.increment, np.eye(4))
    assert first.unobserved_translation.shape == first.unobserved_rotation.shape == (3, 3)
    pose = np.eye(4)
    for scan, step in zip(scans[1:], others):
        pose = pose @ step.increment
        assert step.state == "tracked" and step.reason == "" and not step.predicted
        assert np.allclose(step.pose, pose, atol=1e-9)
        assert np.linalg.eigvalsh(step.covariance).min() > 0
        assert step.unobserved_translation.shape == step.unobserved_rotation.shape == (0, 3)
        assert step.dynamic.shape == (len(scan),) and step.dynamic.dtype == bool
        assert step.points.dtype == np.float32 and step.points.shape == (len(step.indices), 3)
        assert step.matches > 100 and 0 < step.residual < 0.2
        assert step.times_ms["planes"] > 0 and step.details
    assert any(step.dynamic.any() for step in others)


def test_sensor_pose_moves_the_vehicle(drive):
    """A sensor that looks to the left moves along its -y; its vehicle along x."""
    left = np.array([[0.0, -1, 0, 0.3], [1, 0, 0, 0], [0, 0, 1, 1.7], [0, 0, 0, 1]])
    rotation = left[:3, :3].T.astype(np.float32)
    plain, turned = delio.Odometry(), delio.Odometry()
    for scan in delio.open_scans(drive):
        sensor = plain.process(scan)
        vehicle = turned.process(scan.points @ rotation.T, scan.stamp, sensor_pose=left)
    assert sensor.pose[0, 3] > 10
    assert np.linalg.norm(vehicle.increment[:3, 3] - rotation @ sensor.increment[:3, 3]) < 0.05
    assert vehicle.pose[0, 3] > 10 and abs(vehicle.pose[1, 3] - sensor.pose[1, 3]) < 1


POINTS = np.random.default_rng(1).uniform(-20, 20, (500, 3)).astype(np.float32)


@pytest.mark.parametrize("arguments, message", [
    ((POINTS[:, :2], 0.0), "'points' must be a float32 or float64 array of shape (N, 3), not float32 of shape (500, 2)"),
    ((POINTS.astype(int), 0.0), "'points' must be a float32 or float64 array of shape (N, 3), not int64 of shape (500, 3)"),
    (([[1, 2, 3]], 0.0), "'points' must be a float32 or float64 array of shape (N, 3), not list"),
    ((POINTS.ravel(), 0.0), "not float32 of shape (1500,)"),
    ((POINTS,), "'stamp' must be the time of the points in seconds, a number"),
    ((POINTS, "now"), "'stamp' must be the time of the points in seconds, a number"),
    ((POINTS, 0.0, np.zeros(3)), "'times' must be an array of numbers of shape (500,), one for each point, not float64 of shape (3,)"),
    ((POINTS, 0.0, None, np.zeros(500)), "'rings' must be an array of integers of shape (500,), one for each point, not float64 of shape (500,)"),
    ((POINTS, 0.0, None, np.full(500, -1)), "'rings' must be integers from 0 to 65535"),
    ((POINTS, 0.0, None, None, np.array(["x"] * 500)), "'intensity' must be an array of numbers"),
    ((POINTS, 0.0, None, None, None, np.eye(3)), "'sensor_pose' must be an array of shape (4, 4), not float64 of shape (3, 3)"),
    ((POINTS, 0.0, None, None, None, np.ones((4, 4))), "'sensor_pose' must be a rigid motion"),
    ((delio.Scan(POINTS, 0.0), 1.0), "a Scan has its own 'stamp'; leave it out"),
])
def test_wrong_arguments_are_errors_in_one_line(arguments, message):
    odometry = delio.Odometry()
    with pytest.raises(delio.Error) as caught:
        odometry.process(*arguments)
    assert message in str(caught.value) and "\n" not in str(caught.value)
    assert odometry.process(POINTS, 0.0).state == "weak"  # as if nothing had been


@pytest.mark.parametrize("make, message", [
    (lambda: delio.Odometry("best"), "unknown profile 'best'; choose one of: accurate"),
    (lambda: delio.Odometry(scan__colour=1), "scan.colour"),
    (lambda: delio.Odometry(scan__min_range=-1), "scan.min_range"),
    (lambda: delio.Odometry(recording="here"), "'recording' must be what delio.open_scans() returns, or None"),
    (lambda: delio.open_scans("/nowhere"), "/nowhere"),
])
def test_wrong_options_are_errors(make, message):
    with pytest.raises(delio.Error) as caught:
        make()
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_options(drive):
    scan = next(delio.open_scans(drive))
    near = delio.Odometry(**{"scan.max_range": 20}).process(scan)
    assert np.linalg.norm(near.points, axis=1).max() <= 20
    assert delio.Odometry(scan__deskew=False, scan__max_range=20).process(scan).points.shape == near.points.shape
    assert set(delio.profiles()) >= {"accurate", "paper"}


def test_scan_keeps_what_it_was_made_of():
    times, rings = np.linspace(0, 0.1, 500), np.arange(500)
    scan = delio.Scan(POINTS, 12.5, times, rings, rings, np.eye(4), index=7)
    assert len(scan) == 500 and scan.stamp == 12.5 and scan.index == 7
    assert np.array_equal(scan.points, POINTS) and scan.points.dtype == np.float32
    assert np.array_equal(scan.times, times.astype(np.float32))
    assert np.array_equal(scan.rings, rings) and scan.rings.dtype == np.uint16
    assert np.array_equal(scan.intensity, rings.astype(np.float32))
    bare = delio.Scan(POINTS, 0)
    assert bare.times is None and bare.rings is None and bare.intensity is None
    assert np.array_equal(bare.sensor_pose, np.eye(4))


def test_scans_of_a_recording(drive):
    scans = delio.open_scans(drive)
    assert scans.path == str(drive) and "KITTI" in scans.description
    assert scans.calibration.shape == (4, 4)
    assert [scan.index for scan in scans] == list(range(20))
    assert list(scans) == []


def test_other_threads_run_meanwhile(drive):
    """A second thread comes in while a scan is registered, and is refused."""
    scans = list(delio.open_scans(drive))
    odometry, refused, done = delio.Odometry(), [], threading.Event()

    def disturb():
        while not done.is_set() and not refused:
            try:
                odometry.process(POINTS, 1e9)
            except delio.Error as error:
                refused.append(str(error))

    thread = threading.Thread(target=disturb)
    thread.start()
    for scan in scans:
        try:
            odometry.process(scan)
        except delio.Error as error:
            refused.append(str(error))
    done.set()
    thread.join()
    assert refused and set(refused) == {"another thread is using this object; give each thread its own"}
