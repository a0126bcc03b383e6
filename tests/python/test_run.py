import numpy as np
import pytest

import delio

HAVE_TIMES = {"scans.csv", "summary.yaml"}


def assert_same_files(own, others):
    names = {path.name for path in others.iterdir()}
    assert {path.name for path in own.iterdir()} == names and len(names) > 15
    for name in names - HAVE_TIMES:
        assert (own / name).read_bytes() == (others / name).read_bytes(), name


def test_run_writes_the_files_of_delio_slam(drive, results, tmp_path):
    done = []
    result = delio.run(drive, tmp_path / "run", progress=done.append)
    assert_same_files(tmp_path / "run", results)
    assert done == list(range(1, 21))
    poses, stamps = delio.read_trajectory(results / "trajectory_tum.txt")
    assert np.allclose(result.poses, poses, atol=1e-6) and np.allclose(result.stamps, stamps)
    assert result.predicted == 0 and result.loops == [] and 15 < result.path_m < 20
    assert result.metrics.ape_m < 0.1


def test_slam_saves_the_files_of_delio_slam(drive, results, tmp_path):
    scans = delio.open_scans(drive)
    slam = delio.Slam(recording=scans, drive="kitti")
    states = [slam.process(scan).state for scan in scans]
    assert states[1:] == ["tracked"] * 19
    slam.save(tmp_path / "slam")
    for name in ("trajectory_kitti.txt", "posegraph.g2o", "map.ply", "map.delio"):
        assert (tmp_path / "slam" / name).read_bytes() == (results / name).read_bytes(), name
    cloud = slam.cloud()
    assert cloud.dtype == np.float32 and cloud.shape[1] == 3 and len(cloud) > 1000
    assert np.array_equal(slam.finish().poses, slam.finish().odometry_poses)
    with pytest.raises(delio.Error, match="accepts no more scans"):
        slam.process(next(delio.open_scans(drive)))


def test_slam_without_a_scan_or_a_map(drive):
    with pytest.raises(delio.Error, match="no scan was processed yet"):
        delio.Slam().finish()
    slam = delio.Slam(build_map=False)
    slam.process(next(delio.open_scans(drive)))
    with pytest.raises(delio.Error, match="there is no map"):
        slam.cloud()


def test_run_leaves_out_the_own_vehicle(drive, tmp_path):
    corners = ((-8, -2, -2), (-3, 2, 1))
    mask = tmp_path / "mask.txt"
    mask.write_text("box -8 -2 -2 -3 2 1\n")
    runs = {name: delio.run(drive, tmp_path / name, build_map=False, pictures=False, count=5, vehicle_box=box)
            for name, box in {"all": None, "box": corners, "file": mask, "text": str(mask)}.items()}
    assert np.array_equal(runs["box"].poses, runs["file"].poses)
    assert np.array_equal(runs["box"].poses, runs["text"].poses)
    assert not np.array_equal(runs["box"].poses, runs["all"].poses)
    counts = [len(next(delio.open_scans(drive, vehicle_box=box))) for box in (None, corners, mask)]
    assert counts[0] > counts[1] == counts[2]
    mask.write_text("box 1 2 3\n")
    with pytest.raises(delio.Error, match="mask.txt', line 1: expected box"):
        delio.run(drive, tmp_path / "bad", vehicle_box=mask)
    with pytest.raises(delio.Error, match="must be a file or two corners"):
        delio.open_scans(drive, vehicle_box=5)


def test_run_takes_some_scans_and_leaves_parts_out(drive, tmp_path):
    result = delio.run(drive, tmp_path / "some", start=2, count=5, every=3, build_map=False,
                       pictures=False, scan__max_range=60)
    assert result.poses.shape == (5, 4, 4)
    assert np.allclose(np.diff(result.stamps), 0.3, atol=0.02)
    names = {path.name for path in (tmp_path / "some").iterdir()}
    assert "map.ply" not in names and "trajectory.png" not in names
    assert "max_range = 60" in (tmp_path / "some" / "config.ini").read_text()


def test_run_refuses_to_overwrite(drive, results, tmp_path):
    before = (results / "summary.yaml").read_bytes()
    with pytest.raises(delio.Error, match="give force=True"):
        delio.run(drive, results)
    assert (results / "summary.yaml").read_bytes() == before
    (tmp_path / "trajectory_kitti.txt").write_bytes((results / "trajectory_kitti.txt").read_bytes())
    with pytest.raises(delio.Error, match="is also the input"):
        delio.run(drive, tmp_path, force=True, ground_truth=tmp_path / "trajectory_kitti.txt")


def test_what_progress_raises_ends_the_run_with_results(drive, tmp_path):
    def stop(done):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        delio.run(drive, tmp_path / "stopped", progress=stop, pictures=False)
    poses, _ = delio.read_trajectory(tmp_path / "stopped")
    assert poses.shape == (4, 4, 4)
    assert "complete: false" in (tmp_path / "stopped" / "summary.yaml").read_text()


def test_a_run_that_fails_is_an_error(tmp_path):
    folder = tmp_path / "empty"
    folder.mkdir()
    with pytest.raises(delio.Error) as caught:
        delio.run(folder, tmp_path / "out")
    assert "\n" not in str(caught.value) and "empty" in str(caught.value)
    with pytest.raises(delio.Error, match="'every' must be at least 1"):
        delio.run(folder, tmp_path / "out", every=0)
    with pytest.raises(delio.Error, match="need 'map'"):
        delio.run(folder, tmp_path / "out", extend=True)
