class Pipeline:
    """The base class; what it does not implement raises, as its C++ does."""

    def __init__(self):
        self._poses, self._features, self._visualizing = [], [], None

    @staticmethod
    def name():
        raise RuntimeError("Not implemented")

    @staticmethod
    def version():
        return "0.0.0"

    @staticmethod
    def url():
        return "url-not-set"

    @staticmethod
    def default_params():
        raise RuntimeError("Not implemented")

    def map(self):
        raise RuntimeError("Not implemented")

    set_imu_params = set_lidar_params = set_imu_T_lidar = set_params = lambda self, _: self.map()
    add_imu = add_lidar = lambda self, mm: self.map()
    initialize = map

    def set_visualizing(self, visualize):
        self._visualizing = visualize

    def save(self, stamp, what):
        if isinstance(what, dict):
            if self._visualizing is not None:
                self._features.append((stamp, what))
        else:
            self._poses.append((stamp, what))

    def saved_estimates(self):
        poses, self._poses = self._poses, []
        return poses

    def saved_features(self):
        features, self._features = self._features, []
        return features
