#include "delio/scan/scan.h"

#include <string>

#include "delio/core/error.h"

namespace delio {
namespace {
void requireOneForEach(const char* field, std::size_t values, const Scan& scan) {
    const std::size_t points = scan.points->size();
    if (values != 0 && values != points)
        throw Error("scan " + std::to_string(scan.index) + ": " + field + " has " +
                    std::to_string(values) + " values for " + std::to_string(points) +
                    " points: give one for each point, or none");
}
}  // namespace

void requireConsistent(const Scan& scan) {
    const std::string name = "scan " + std::to_string(scan.index);
    if (!scan.points) throw Error(name + ": points is null: give a points map, which may be empty");
    requireOneForEach("rings", scan.rings.size(), scan);
    requireOneForEach("times_s", scan.times_s.size(), scan);
    if (!scan.sensorPose.matrix().allFinite()) throw Error(name + ": sensorPose is not finite");
}
}  // namespace delio
