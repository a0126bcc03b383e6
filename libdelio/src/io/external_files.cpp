#include "external_files.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "delio/core/error.h"
#include "gz_input.h"

namespace delio::io {
namespace {
namespace fs = std::filesystem;
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationPointCloud;

/** How and where a cloud is stored outside of its rawlog: MRPT lets derived classes only at it. */
struct External : CObservationPointCloud {
    static ExternalStorageFormat formatOf(const CObservationPointCloud& cloud) {
        return cloud.*(&External::m_externally_stored);
    }
    static void setFile(CObservationPointCloud& cloud, const std::string& file) {
        cloud.*(&External::m_external_file) = file;
    }
};

/** The same of a depth camera's scan. */
struct ExternalRanges : CObservation3DRangeScan {
    static void setPoints(CObservation3DRangeScan& scan, const std::string& file) {
        scan.*(&ExternalRanges::m_points3D_external_file) = file;
    }
    static void setRanges(CObservation3DRangeScan& scan, const std::string& file) {
        scan.*(&ExternalRanges::m_rangeImage_external_file) = file;
    }
};

/** The first float of one in 65536 scans of KITTI's format begins like a gzip file, and zlib takes
 *  it for one; the method, the third byte, tells (RFC 1952). */
bool isTakenForGzip(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::array<unsigned char, 3> begin{};
    in.read(reinterpret_cast<char*>(begin.data()), begin.size());
    constexpr unsigned char kDeflate = 8;
    return in && begin[0] == 0x1F && begin[1] == 0x8B && begin[2] != kDeflate;
}

/** KITTI's format, uncompressed: x, y, z and intensity of each point. */
mrpt::maps::CPointsMap::Ptr readKittiPoints(const std::string& file) {
    std::vector<float> floats(fs::file_size(file) / sizeof(float));
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(floats.data()),
            static_cast<std::streamsize>(floats.size() * sizeof(float)));
    if (!in) throw std::runtime_error("the file ends early");
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(floats.size() / 4);
    for (std::size_t i = 0; i < points->size(); ++i) {
        const float* p = &floats[4 * i];
        points->setPointFast(i, p[0], p[1], p[2]);
        points->setPointIntensity(i, p[3]);
    }
    points->mark_as_modified();
    return points;
}
/** Where `name` is in the folders, by its whole name. */
fs::path found(const fs::path& name, const std::vector<std::string>& folders) {
    std::string tried;
    for (const fs::path folder : folders) {
        const fs::path file = name.is_absolute() ? name : folder / name;
        if (fs::exists(file)) return fs::absolute(file);
        tried += (tried.empty() ? "'" : ", '") + file.parent_path().string() + "'";
    }
    throw Error("its external file '" + name.string() + "' is in none of the folders tried: " +
                tried + "; name the right one with --images");
}

/** Loads it from `file`. */
void load(CObservationPointCloud& cloud, const fs::path& file) {
    // MRPT does not see that compressed data is damaged or cut off, and KITTI's format has no
    // header: only its size can tell.
    const bool isKitti = External::formatOf(cloud) == External::ExternalStorageFormat::KittiBinFile;
    const bool isPlain = isKitti && isTakenForGzip(file.string());
    const auto size = isPlain ? fs::file_size(file) : unpackedSize(file.string());
    if (isKitti && size % (4 * sizeof(float)) != 0)
        throw Error("'" + file.string() + "' is cut off: its size is no multiple of 16 bytes");
    if (isPlain) {
        cloud.pointcloud = readKittiPoints(file.string());
        return;
    }
    External::setFile(cloud, file.string());
    cloud.load();
}

std::string loadRanges(CObservation3DRangeScan& scan, const std::vector<std::string>& folders) {
    std::string from;
    try {
        if (scan.hasRangeImage && scan.rangeImage_isExternallyStored()) {
            from = found(scan.rangeImage_getExternalStorageFile(""), folders).string();
            unpackedSize(from);  // MRPT does not see that it is damaged
            ExternalRanges::setRanges(scan, from);
        }
        if (scan.hasPoints3D && scan.points3D_isExternallyStored()) {
            from = found(scan.points3D_getExternalStorageFile(), folders).string();
            unpackedSize(from);
            ExternalRanges::setPoints(scan, from);
        }
        scan.load();
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {
        throw Error("cannot read its points from '" + from + "'");
    }
    return from;
}
}  // namespace

std::string loadExternal(mrpt::obs::CObservation& observation,
                         const std::vector<std::string>& folders) {
    if (auto* const ranges = dynamic_cast<CObservation3DRangeScan*>(&observation))
        return loadRanges(*ranges, folders);
    auto* const cloud = dynamic_cast<CObservationPointCloud*>(&observation);
    if (!cloud || !cloud->isExternallyStored()) {
        observation.load();
        return "";
    }
    const fs::path file = found(cloud->getExternalStorageFile(), folders);
    try {
        load(*cloud, file);
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {
        throw Error("cannot read its points from '" + file.string() + "'");
    }
    return file.string();
}
}  // namespace delio::io
