#pragma once

// What most of the library includes, and what takes longest to read: compiled once where
// DELIO_PRECOMPILE_LIBRARY is on (share/scripts/test). No file may rely on it:
// share/scripts/sanitize builds without.
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/serialization/CArchive.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>
