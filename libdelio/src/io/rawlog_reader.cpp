#include "delio/io/rawlog_reader.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "delio/core/error.h"
#include "delio/io/decode_observation.h"
#include "drive_clock.h"
#include "gz_input.h"
#include "point_extras.h"
#include "rawlog_archive.h"
#include "side_file.h"

namespace delio::io {
namespace fs = std::filesystem;
using mrpt::obs::CObservation;
using mrpt::obs::CObservationPointCloud;

namespace {
/** How and where a cloud is stored outside of its rawlog: MRPT lets derived classes only at it. */
struct External : CObservationPointCloud {
    static ExternalStorageFormat formatOf(const CObservationPointCloud& cloud) {
        return cloud.*(&External::m_externally_stored);
    }
    static void setFile(CObservationPointCloud& cloud, const std::string& file) {
        cloud.*(&External::m_external_file) = file;
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
}  // namespace

RawlogReader::RawlogReader(const std::string& path, std::string label, std::string imagesFolder)
    : path_(path),
      label_(std::move(label)),
      imagesFolder_(std::move(imagesFolder)),
      meta_(readDriveMeta(path_)),
      in_(std::make_unique<GzInput>(path_)) {
    if (in_->getTotalBytesCount() == 0) throw Error("'" + path_ + "' is empty: not a rawlog");
}

RawlogReader::~RawlogReader() = default;

std::optional<double> RawlogReader::fraction() const {
    if (in_->compressed()) return {};
    return static_cast<double>(in_->getPosition()) / static_cast<double>(in_->getTotalBytesCount());
}

Recording RawlogReader::recording() const {
    Recording recording;
    recording.kind = "rawlog";
    if (meta_) {
        if (meta_->sensorModel != "unknown") recording.sensor = meta_->sensorModel;
        recording.motionCompensated = meta_->motionCompensated;
    }
    return recording;
}

SideFile RawlogReader::calibration() const { return sideFile(sidecarPath(path_, ".calib.txt")); }

SideFile RawlogReader::truth() const { return sideFile(sidecarPath(path_, ".poses.txt")); }

std::optional<Scan> RawlogReader::next() {
    const auto observation = nextObservation();
    if (!observation) return {};
    Scan scan;
    try {
        const std::string file = loadExternal(*observation);
        scan = decodeObservation(*observation);
        readPointExtras(
            file.empty() ? embeddedStem(count_ - 1) : fs::path(file).replace_extension().string(),
            scan);
    } catch (const std::exception& e) {
        ended_ = true;
        throw Error("scan " + std::to_string(count_ - 1) + " of '" + path_ +
                    "': " + plainMessage(e));
    }
    scan.index = count_ - 1;
    scan.stamp_s = secondsSince(meta_ ? meta_->epoch_s : 0, observation->timestamp);
    scan.time = observation->timestamp;
    return scan;
}

bool RawlogReader::skip() { return nextObservation() != nullptr; }

CObservation::Ptr RawlogReader::nextObservation() {
    while (true) {
        while (pending_.empty())
            if (!readEntry()) return {};
        auto observation = pending_.front();
        pending_.pop_front();
        if (label_.empty()) label_ = observation->sensorLabel;
        if (observation->sensorLabel == label_) {
            ++count_;
            return observation;
        }
        otherLabels_.insert(observation->sensorLabel);
    }
}

bool RawlogReader::readEntry() {
    if (ended_) return false;
    const auto before = in_->getPosition();
    mrpt::serialization::CSerializable::Ptr object;
    try {
        object = RawlogArchive(*in_).ReadObject();
    } catch (const std::exception&) {
        ended_ = true;
        // Nothing was left to read: the end of the rawlog. Otherwise something is only half there,
        // or is damaged and perhaps claims more than there is memory for.
        if (in_->getPosition() == before && before > 0 && in_->endedWell()) return false;
        throw Error("'" + path_ + "' " +
                    (before == 0 ? "is not a rawlog, or damaged at its very beginning"
                                 : "is cut off or damaged " +
                                       (count_ == 0 ? "before its first scan"
                                                    : "after scan " + std::to_string(count_ - 1)) +
                                       " (byte " + std::to_string(before) + ")"));
    }
    const auto accept = [&](const CObservation::Ptr& observation) {
        if (observation && isScan(*observation)) pending_.push_back(observation);
    };
    accept(std::dynamic_pointer_cast<CObservation>(object));
    if (const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object))
        for (const auto& observation : *frame) accept(observation);
    return true;
}

std::vector<std::string> RawlogReader::imagesFolders() const {
    if (!imagesFolder_.empty()) return {imagesFolder_};
    return {sidecarPath(path_, "_Images"), (fs::path(path_).parent_path() / "Images").string()};
}

std::string RawlogReader::embeddedStem(std::size_t scan) const {
    char name[32];
    std::snprintf(name, sizeof(name), "%06zu", scan);
    return (fs::path(imagesFolders().front()) / name).string();
}

std::string RawlogReader::loadExternal(CObservation& observation) const {
    auto* const cloud = dynamic_cast<CObservationPointCloud*>(&observation);
    if (!cloud || !cloud->isExternallyStored()) {
        observation.load();
        return "";
    }
    const fs::path name = cloud->getExternalStorageFile();
    std::string tried;
    for (const fs::path folder : imagesFolders()) {
        const fs::path file = name.is_absolute() ? name : folder / name;
        tried += (tried.empty() ? "'" : ", '") + file.parent_path().string() + "'";
        if (!fs::exists(file)) continue;
        try {
            // MRPT does not see that compressed data is damaged or cut off, and KITTI's format has
            // no header: only its size can tell.
            const bool isKitti =
                External::formatOf(*cloud) == External::ExternalStorageFormat::KittiBinFile;
            const bool isPlain = isKitti && isTakenForGzip(file.string());
            const auto size = isPlain ? fs::file_size(file) : unpackedSize(file.string());
            if (isKitti && size % (4 * sizeof(float)) != 0)
                throw Error("'" + file.string() +
                            "' is cut off: its size is no multiple of 16 bytes");
            if (isPlain) {
                cloud->pointcloud = readKittiPoints(file.string());
                return file.string();
            }
            // A relative name MRPT would look for in a folder that is the whole process's.
            External::setFile(*cloud, fs::absolute(file).string());
            cloud->load();
        } catch (const Error&) {
            throw;
        } catch (const std::exception&) {
            throw Error("cannot read its points from '" + file.string() + "'");
        }
        return file.string();
    }
    throw Error("its external file '" + name.string() + "' is in none of the folders tried: " +
                tried + "; name the right one with --images");
}
}  // namespace delio::io
