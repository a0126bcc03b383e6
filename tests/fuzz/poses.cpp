#include "delio/evaluation/comparison.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "target.h"

/** The texts beside a drive: poses (KITTI and TUM), times, calibration, meta.yaml. Two pose files,
 * a zero byte between them, are compared as delio-eval does. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    const auto kind = input.pick(5);
    return fuzz::mayRefuse([&] {
        if (kind == 0) {
            io::readTrajectory(fuzz::fileOf(input.rest(), "poses.txt"));
        } else if (kind == 1) {
            io::readTimes(fuzz::fileOf(input.rest(), "times.txt"));
        } else if (kind == 2) {
            io::readCalibration(fuzz::fileOf(input.rest(), "calib.txt"));
        } else if (kind == 3) {
            fuzz::fileOf(input.rest(), "d.meta.yaml");
            io::readDriveMeta((fuzz::folder() / "d.rawlog").string());
        } else {
            const auto reference = io::trajectoryIn(input.cutText(), "reference");
            const auto estimate = io::trajectoryIn(input.rest(), "estimate");
            evaluation::compare(reference, estimate, {});
        }
    });
}
