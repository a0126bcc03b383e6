#include <array>

#include "scans.h"

using namespace delio::fuzz;

namespace {
const std::string kTr = "1 0 0 0 0 1 0 0 0 0 1 0";
const std::string kScan(32, '\0');

/** What a file of one of the two folders is beside the one that is fed. */
struct File {
    const char* path;
    std::string usual;
};
const std::array<File, 9> kFiles{
    {{"odometry/calib.txt", "Tr: " + kTr + "\n"},
     {"odometry/times.txt", "0\n0.1\n"},
     {"odometry/poses.txt", kTr + "\n" + kTr + "\n"},
     {"odometry/velodyne/000000.bin", kScan},
     {"day/calib_velo_to_cam.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n"},
     {"day/calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n"},
     {"day/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n"},
     {"day/drive/velodyne_points/timestamps.txt", "2011-09-26 13:02:25.9\n"},
     {"day/drive/oxts/data/0000000000.txt", "49 8 110 0 0 0 0 0\n"}}};
}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    for (const File& file : kFiles) fileOf(file.usual, file.path);
    fileOf(kScan, "odometry/velodyne/000001.bin");
    fileOf(kScan, "day/drive/velodyne_points/data/0000000000.bin");
    return 0;
}

/** KITTI's folders: odometry, and raw with its calibration in the folder above. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input input(data, size);
    const File& file = kFiles[input.pick(kFiles.size())];
    fileOf(input.rest(), file.path);
    const bool raw = file.path[0] == 'd';
    readScans({(folder() / (raw ? "day/drive" : "odometry")).string(), "", "", ""});
    fileOf(file.usual, file.path);
    return 0;
}
