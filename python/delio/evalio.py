"""DeLiO as a pipeline of evalio (https://github.com/contagon/evalio):

    EVALIO_CUSTOM=delio.evalio evalio run -o results -d newer_college_2020/* -p delio
"""

import numpy as np
from evalio.pipelines import Pipeline
from evalio.types import SE3, Point

import delio


class DeLiO(Pipeline):
    """LiDAR alone: samples of the IMU are ignored; poses are those of the IMU, as evalio has it."""

    def __init__(self):
        super().__init__()
        self._params = self.default_params()
        self._lidar_from_imu = np.eye(4)
        self._odometry = None
        self._shown = False
        self._points = np.zeros((0, 3))  # of the last scan

    @staticmethod
    def name():
        return "delio"

    @staticmethod
    def version():
        return delio.__version__

    @staticmethod
    def default_params():
        """The profile, and options of [scan]: de-skewing, and ranges in metres."""
        return {"profile": "accurate", "deskew": True, "min_range": 2.5, "max_range": 100.0}

    def set_params(self, params):
        """Takes the parameters that it has and returns the others."""
        self._params.update({key: params[key] for key in params if key in self._params})
        return {key: params[key] for key in params if key not in self._params}

    def set_lidar_params(self, params):
        pass  # DeLiO finds what it needs in the scans

    def set_imu_params(self, params):
        pass

    def set_imu_T_lidar(self, T):
        self._lidar_from_imu = np.linalg.inv(np.asarray(T.to_mat()))

    def set_visualizing(self, visualize):
        self._shown = visualize is not None
        super().set_visualizing(visualize)

    def initialize(self):
        """Starts a drive. A parameter with its default value is left to DeLiO, which may scale it
        with the size of the place."""
        default = self.default_params()
        options = {"scan__" + key: value for key, value in self._params.items()
                   if key != "profile" and value != default[key]}
        self._odometry = delio.Odometry(self._params["profile"], **options)

    def add_imu(self, mm):
        pass

    def add_lidar(self, mm):
        points = np.array(mm.to_vec_positions(), dtype=np.float64).reshape(-1, 3)
        times = np.array(mm.to_vec_stamps(), dtype=np.float64)
        hit = np.isfinite(points).all(axis=1) & points.any(axis=1)  # zeros are no returns
        step = self._odometry.process(points[hit], mm.stamp.to_sec(), times=times[hit])
        self.save(mm.stamp, SE3.from_mat(step.pose @ self._lidar_from_imu))
        if self._shown:
            self._points = step.points
            self.save(mm.stamp, self.map())

    def map(self):
        """The points of the last scan: evalio only draws them."""
        return {"point": [Point(x=x, y=y, z=z) for x, y, z in self._points.astype(float).tolist()]}
