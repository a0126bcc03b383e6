#include "external_files.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "delio/core/error.h"
#include "files/gz.h"
#include "files/names.h"
#include "object_archive.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
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
    /** All that a file has. */
    static std::array<bool*, 7> flagsOf(CObservation3DRangeScan& scan) {
        return {&scan.hasPoints3D,
                &scan.hasRangeImage,
                &scan.range_is_depth,
                &scan.hasIntensityImage,
                &scan.hasConfidenceImage,
                &(scan.*(&ExternalRanges::m_points3D_external_stored)),
                &(scan.*(&ExternalRanges::m_rangeImage_external_stored))};
    }
    static void setPoints(CObservation3DRangeScan& scan, const std::string& file) {
        scan.*(&ExternalRanges::m_points3D_external_file) = file;
    }
    static void setRanges(CObservation3DRangeScan& scan, const std::string& file) {
        scan.*(&ExternalRanges::m_rangeImage_external_file) = file;
    }
};

/** The first float of one in 65536 scans of KITTI's format begins like a gzip file, and zlib takes
 *  it for one; the third byte, the method, differs (RFC 1952). */
bool isTakenForGzip(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::array<unsigned char, 3> begin{};
    in.read(reinterpret_cast<char*>(begin.data()), begin.size());
    constexpr unsigned char kDeflate = 8;
    return in && begin[0] == 0x1F && begin[1] == 0x8B && begin[2] != kDeflate;
}

/** KITTI's format: x, y, z and intensity of each point, `size` bytes in all. (MRPT adds point by
 *  point, and ends the program where memory for an error message is missing.) */
mrpt::maps::CPointsMap::Ptr readKittiPoints(const std::string& file, std::uint64_t size) {
    std::vector<float> floats(size / sizeof(float));
    if (isTakenForGzip(file)) {
        std::ifstream in(file, std::ios::binary);
        in.read(reinterpret_cast<char*>(floats.data()), static_cast<std::streamsize>(size));
        if (!in) throw std::runtime_error("the file ends early");
    } else if (GzInput(file).Read(floats.data(), size) != size) {
        throw std::runtime_error("the file ends early");
    }
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

/** Throws Error for a name that leads out of its folder: a foreign rawlog must not choose
 *  which files are read. (A link in the folder is its owner's.) */
void refuseOutside(const fs::path& name) {
    if (name.empty() || !name.has_filename())
        throw Error("its points are in another file, but it does not say which");
    if (!staysInside(name))
        throw Error("its external file '" + name.string() +
                    "' leads out of the folder of such files: it is not read");
}

/** Where `name` is in the folders, by its whole name. */
fs::path found(const fs::path& name, const std::vector<std::string>& folders) {
    refuseOutside(name);
    std::string tried;
    for (const fs::path folder : folders) {
        const fs::path file = folder / name;
        std::error_code ignored;
        if (fs::is_regular_file(file, ignored)) return fs::absolute(file);
        tried += (tried.empty() ? "'" : ", '") + file.parent_path().string() + "'";
    }
    throw Error("its external file '" + name.string() + "' is in none of the folders tried: " +
                tried + "; name the right one with --images");
}

mrpt::maps::CPointsMap::Ptr readCloud(const std::string& file) {
    GzInput in(file);
    ObjectArchive archive(in, FileOf::Scans);
    auto cloud = std::dynamic_pointer_cast<mrpt::maps::CPointsMap>(archive.next());
    if (!cloud) throw Error("'" + file + "' holds something else than a cloud");
    return cloud;
}

/** Loads it from `file`. */
void load(CObservationPointCloud& cloud, const fs::path& file) {
    // MRPT does not see that compressed data is damaged or cut off, and KITTI's format has no
    // header: only its size can be checked.
    using Format = External::ExternalStorageFormat;
    const bool isKitti = External::formatOf(cloud) == Format::KittiBinFile;
    const auto size = isKitti && isTakenForGzip(file.string()) ? fs::file_size(file)
                                                               : unpackedSize(file.string());
    if (isKitti && size % (4 * sizeof(float)) != 0)
        throw Error("'" + file.string() + "' is cut off: its size is no multiple of 16 bytes");
    External::setFile(cloud, file.string());
    if (isKitti)
        cloud.pointcloud = readKittiPoints(file.string(), size);
    else if (External::formatOf(cloud) == Format::MRPT_Serialization)
        cloud.pointcloud = readCloud(file.string());
    else
        cloud.load();
}

/** MRPT takes the size of a range image from its file without a look whether that is there. */
void checkRangeImage(const std::string& file, std::uint64_t bytes) {
    if (fs::path(file).extension() == ".txt") return;
    std::array<std::uint32_t, 2> size{};  // rows and columns
    GzInput(file).Read(size.data(), sizeof(size));
    if (std::uint64_t{2} * size[0] * size[1] != bytes - sizeof(size) || bytes < sizeof(size))
        throw Error("'" + file + "' is damaged: it has not as many ranges as it claims");
}

/** MRPT reads any byte of a file into a bool. */
void makeTrueOrFalse(bool& flag) {
    unsigned char byte = 0;
    std::memcpy(&byte, &flag, 1);
    flag = byte != 0;
}

/** The same of the numbers of its coordinates: three lists, each with its count before it. */
void checkPoints(const std::string& file, std::uint64_t bytes) {
    if (fs::path(file).extension() == ".txt") return;
    GzInput in(file);
    std::vector<float> list;
    for (int axis = 0; axis < 3; ++axis) {
        std::uint32_t count = 0;
        in.Read(&count, sizeof(count));
        if (std::uint64_t{count} * sizeof(float) > bytes - std::min(bytes, in.getPosition()))
            throw Error("'" + file + "' is damaged: it has not as many points as it claims");
        list.resize(count);
        in.Read(list.data(), count * sizeof(float));
    }
}

void loadRanges(CObservation3DRangeScan& scan, std::string& from,
                const std::vector<std::string>& folders) {
    for (bool* flag : ExternalRanges::flagsOf(scan)) makeTrueOrFalse(*flag);
    const auto check = [&](const std::string& name) {
        from = found(name, folders).string();
        return unpackedSize(from);  // MRPT does not see that it is damaged
    };
    if (scan.hasRangeImage && scan.rangeImage_isExternallyStored()) {
        const auto bytes = check(scan.rangeImage_getExternalStorageFile(""));
        checkRangeImage(from, bytes);
        ExternalRanges::setRanges(scan, from);
        scan.rangeImageOtherLayers.clear();  // these have files of their own, and are not used
    }
    if (scan.hasPoints3D && scan.points3D_isExternallyStored()) {
        const auto bytes = check(scan.points3D_getExternalStorageFile());
        checkPoints(from, bytes);
        ExternalRanges::setPoints(scan, from);
    }
    scan.load();
}

/** Calls `loads`, which sets `from`, and says that `from` is bad where it fails. */
template <typename Loads>
std::string loaded(std::string from, Loads loads) {
    try {
        loads(from);
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {
        throw Error("cannot read its points" + (from.empty() ? "" : " from '" + from + "'"));
    }
    return from;
}
}  // namespace

std::string loadExternal(mrpt::obs::CObservation& observation,
                         const std::vector<std::string>& folders) {
    if (auto* const ranges = dynamic_cast<CObservation3DRangeScan*>(&observation))
        return loaded("", [&](std::string& from) { loadRanges(*ranges, from, folders); });
    auto* const cloud = dynamic_cast<CObservationPointCloud*>(&observation);
    if (!cloud || !cloud->isExternallyStored()) {
        observation.load();
        return "";
    }
    return loaded(found(cloud->getExternalStorageFile(), folders).string(),
                  [&](const std::string& from) { load(*cloud, from); });
}
}  // namespace delio::io
