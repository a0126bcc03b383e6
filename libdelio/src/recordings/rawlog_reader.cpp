#include "delio/recordings/rawlog_reader.h"

#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "decode_observation.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/odometry/scan.h"
#include "files/gz.h"
#include "files/input_file.h"
#include "gnss.h"
#include "imu_samples.h"
#include "mrpt/clock.h"
#include "mrpt/external_files.h"
#include "mrpt/imu_observation.h"
#include "mrpt/object_archive.h"
#include "odometry_samples.h"

namespace delio::io {
namespace fs = std::filesystem;

using mrpt::obs::CObservation;

namespace {
template <typename Value>
void readValues(const std::string& file, std::size_t count, std::vector<Value>& values) {
    if (!isFileThere(file)) return;
    const auto bytes = fs::file_size(file);
    if (bytes != count * sizeof(Value))
        throw Error("'" + file + "' has " + std::to_string(bytes) + " bytes, but its scan has " +
                    std::to_string(count) + " points of " + std::to_string(sizeof(Value)) +
                    " bytes each");
    values.resize(count);
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(bytes));
    if (!in) throw Error("cannot read '" + file + "'");
}
/** Reads rings and times of the points from STEM.ring (uint16) and STEM.time (float32, seconds from
 *  the stamp), one value per point, if they exist; NaN: no time. Throws Error if a file cannot be
 *  read or has another number of values, or if a time is beyond 1 s. */
void readPointExtras(const std::string& stem, Scan& scan) {
    const std::size_t count = scan.points->size();
    readValues(stem + ".ring", count, scan.rings);
    readValues(stem + ".time", count, scan.times_s);
    constexpr float kLongest_s = 1;  // no LiDAR turns slower than so
    for (const float time_s : scan.times_s)
        if (std::abs(time_s) > kLongest_s)
            throw Error("'" + stem + ".time' has a point time of " + digitsOf(time_s) +
                        " s from its scan's stamp");
}

/** MRPT's words for what another version or program registers; damaged bytes make no name. */
bool isOfUnknownClass(const std::exception& e) {
    static const std::regex words(
        "Stored object has class '[A-Za-z_][A-Za-z0-9_:]*' which is not .*");
    return std::regex_match(plainMessage(e), words);
}
}  // namespace

RawlogReader::RawlogReader(const std::string& path, std::string label, std::string imagesFolder)
    : path_(path),
      label_(std::move(label)),
      imagesFolder_(std::move(imagesFolder)),
      chosen_(!label_.empty()),
      meta_(readDriveMeta(path_)),
      in_(std::make_unique<GzInput>(path_)),
      odometry_(std::make_unique<RawlogOdometry>()) {
    if (in_->getTotalBytesCount() == 0) throw Error("'" + path_ + "' is empty");
}

RawlogReader::~RawlogReader() = default;

std::optional<double> RawlogReader::fraction() const {
    if (in_->compressed()) return {};
    return static_cast<double>(in_->getPosition()) / static_cast<double>(in_->getTotalBytesCount());
}

Recording RawlogReader::recording() const {
    Recording recording;
    recording.kind = "rawlog";
    if (imuLabel_) recording.imu = imuLabel_->empty() ? "without a label" : "'" + *imuLabel_ + "'";
    recording.odometry = odometry_->name().value_or("");
    if (meta_) {
        if (meta_->sensorModel != "unknown") recording.sensor = meta_->sensorModel;
        recording.motionCompensated = meta_->motionCompensated;
    }
    return recording;
}

std::vector<OdometrySample> RawlogReader::takeOdometry() { return odometry_->take(); }

earth::Fixes RawlogReader::takeFixes() { return std::exchange(fixes_, {}); }

SideFile RawlogReader::calibration() const { return sideFile(sidecarPath(path_, ".calib.txt")); }

SideFile RawlogReader::truth() const { return sideFile(sidecarPath(path_, ".poses.txt")); }

std::optional<Scan> RawlogReader::next() {
    const auto observation = nextObservation();
    if (!observation) return {};
    Scan scan;
    try {
        const std::string file = loadExternal(*observation, imagesFolders());
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
        const std::string name = nameOf(*observation);
        if (!chosen_) label_ = name;
        chosen_ = true;
        if (name == label_) {
            ++count_;
            return observation;
        }
        otherLabels_.insert(name);
    }
}

std::string RawlogReader::nameOf(const CObservation& observation) {
    if (!observation.sensorLabel.empty()) return observation.sensorLabel;
    Unlabelled sensor{observation.GetRuntimeClass()->className, {}};
    observation.getSensorPose(sensor.pose);
    const auto known = std::find_if(unlabelled_.begin(), unlabelled_.end(), [&](const auto& other) {
        return other.className == sensor.className && other.pose == sensor.pose;
    });
    const auto number = static_cast<std::size_t>(known - unlabelled_.begin());
    if (known == unlabelled_.end()) unlabelled_.push_back(sensor);
    return number == 0 ? "" : "unlabelled-" + std::to_string(number + 1);
}

bool RawlogReader::readEntry() {
    if (ended_) return false;
    const auto before = in_->getPosition();
    mrpt::serialization::CSerializable::Ptr object;
    ObjectArchive archive(*in_, FileOf::Scans);
    try {
        object = archive.next();
    } catch (const std::exception& e) {
        ended_ = true;
        // No bytes left: the end of the rawlog. Otherwise an object is incomplete or damaged, and
        // may claim more memory than available.
        if (in_->getPosition() == before && before > 0 && in_->endedWell()) return false;
        if (!archive.refused().empty())
            throw Error("'" + path_ + "' holds '" + archive.refused() + "' (byte " +
                        std::to_string(before) + "), a class that is not supported in rawlogs");
        throw Error("'" + path_ + "' " +
                    (before == 0 ? "is not a rawlog, or is damaged at its start"
                                 : "is cut off or damaged " +
                                       (count_ == 0 ? "before its first scan"
                                                    : "after scan " + std::to_string(count_ - 1)) +
                                       " (byte " + std::to_string(before) + ")") +
                    (isOfUnknownClass(e)
                         ? ", or contains something unknown to this MRPT: " + plainMessage(e)
                         : ""));
    }
    accept(std::dynamic_pointer_cast<CObservation>(object));
    if (const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object))
        for (const auto& observation : *frame) accept(observation);
    if (const auto* actions = dynamic_cast<mrpt::obs::CActionCollection*>(object.get()))
        odometry_->add(*actions);
    return true;
}

/** Scans, samples of the first IMU and odometry, and GNSS fixes; what else there is may be null. */
void RawlogReader::accept(const CObservation::Ptr& observation) {
    if (!observation) return;
    const double epoch_s = meta_ ? meta_->epoch_s : 0;
    odometry_->add(*observation, secondsSince(epoch_s, observation->timestamp));
    if (isScan(*observation)) pending_.push_back(observation);
    if (const auto* gnss = dynamic_cast<const mrpt::obs::CObservationGPS*>(observation.get()))
        if (const auto fix = fixOf(*gnss, epoch_s)) fixes_.push_back(*fix);
    const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(observation.get());
    if (!imu) return;
    if (!imuLabel_) imuLabel_ = imu->sensorLabel;
    if (imu->sensorLabel == *imuLabel_)
        addSample(sampleOf(*imu, secondsSince(epoch_s, imu->timestamp)), imu_);
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
}  // namespace delio::io
