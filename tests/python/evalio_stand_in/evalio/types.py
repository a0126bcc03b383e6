from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Duration:
    nsec: int

    def to_sec(self):
        return self.nsec * 1e-9


@dataclass(frozen=True)
class Stamp:
    sec: int
    nsec: int

    def to_sec(self):
        return self.sec + self.nsec * 1e-9


@dataclass
class Point:
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    intensity: float = 0.0
    t: Duration = Duration(0)
    range: int = 0
    row: int = 0
    col: int = 0


@dataclass
class LidarMeasurement:
    stamp: Stamp
    points: list = field(default_factory=list)

    def to_vec_positions(self):
        return [np.array([point.x, point.y, point.z]) for point in self.points]

    def to_vec_stamps(self):
        return [point.t.to_sec() for point in self.points]


class SE3:
    def __init__(self, mat):
        self._mat = mat

    @staticmethod
    def from_mat(mat):
        assert mat.shape == (4, 4) and mat.dtype == np.float64
        return SE3(mat)

    def to_mat(self):
        return self._mat
