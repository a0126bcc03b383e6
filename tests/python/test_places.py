import numpy as np
import pytest

import delio


def test_localiser_finds_a_drive_in_its_own_map(drive, results):
    stored = delio.StoredMap(results)
    poses, stamps = stored.trajectory("kitti")
    assert stored.drives == ["kitti"] and stored.path == str(results / "map.delio")
    assert poses.shape == (20, 4, 4) and stamps.shape == (20,)
    scans = delio.open_scans(drive)
    localiser = delio.Localiser(stored, recording=scans)
    localiser.expect(np.eye(4))
    found = 0
    for scan, pose in zip(scans, poses):
        result = localiser.process(scan)
        if result.where == "unknown":
            assert result.pose is None and result.covariance is None
            continue
        found += 1
        assert result.where == "in_map" and result.step.state in ("weak", "tracked")
        assert np.linalg.norm(result.pose[:3, 3] - pose[:3, 3]) < 0.05
        assert np.linalg.eigvalsh(result.covariance).min() > 0
        if result.measured:
            assert result.reason == "" and 0.5 < result.inlier_ratio <= 1
        assert np.linalg.norm(result.step.pose[:3, 3] - pose[:3, 3]) < 0.3
    assert found >= 15


def test_a_run_is_localised_in_a_map(drive, results, tmp_path):
    result = delio.run(drive, tmp_path / "next", map=results, initial_pose=np.eye(4), pictures=False)
    poses, _ = delio.read_trajectory(results)
    own, _ = delio.StoredMap(results).trajectory("kitti")
    assert np.abs(result.poses[:, :3, 3] - own[:, :3, 3]).max() < 0.1


def test_stored_map(results):
    stored = delio.StoredMap(results / "map.delio")
    fine, coarse = stored.cloud(0.2), stored.cloud(spacing=1.0)
    assert fine.dtype == np.float32 and fine.shape[1] == 3
    assert len(fine) > 2 * len(coarse) > 100
    with pytest.raises(delio.Error, match="has no drive 'other'; it has: kitti"):
        stored.trajectory("other")


def test_wrong_maps_are_errors(drive, tmp_path):
    with pytest.raises(delio.Error, match="contains no map.delio"):
        delio.StoredMap(drive)
    (tmp_path / "map.delio").write_bytes(b"nothing")
    with pytest.raises(delio.Error) as caught:
        delio.StoredMap(tmp_path / "map.delio")
    assert "\n" not in str(caught.value)
    with pytest.raises(TypeError):
        delio.Localiser(None)
