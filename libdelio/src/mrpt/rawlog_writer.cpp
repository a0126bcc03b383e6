#include "delio/mrpt/rawlog_writer.h"

#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <utility>

#include "clock.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "imu_observation.h"
#include "odometry_observation.h"

namespace delio::io {
namespace fs = std::filesystem;

using mrpt::obs::CObservationPointCloud;

namespace {
constexpr const char* kImages = "_Images";
constexpr const char* kSideFiles[] = {".meta.yaml",  ".times.txt",  ".calib.txt", ".poses.txt",
                                      ".faults.tsv", ".origin.txt", ".imu.yaml",  ".gnss.csv"};

/** `path`, if it can be a drive's. */
const std::string& checked(const std::string& path) {
    if (fs::path(path).extension() != ".rawlog")
        throw Error("'" + path + "' does not end in .rawlog; name the output OUT.rawlog");
    if (fs::is_directory(path))
        throw Error("'" + path + "' is a folder; choose another name for the rawlog");
    const fs::path folder = folderOf(path);
    if (!fs::is_directory(folder))
        throw Error("cannot write '" + path + "': there is no folder '" + folder.string() + "'");
    return path;
}

/** The rawlog has the name of the file only. */
void setExternal(CObservationPointCloud& observation, const std::string& file) {
    observation.setAsExternalStorage(fs::path(file).filename().string(),
                                     CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
}

mrpt::maps::CPointsMapXYZI::Ptr cloudOf(const std::vector<float>& xyzi) {
    auto cloud = mrpt::maps::CPointsMapXYZI::Create();
    cloud->resize(xyzi.size() / 4);
    for (std::size_t i = 0; i < xyzi.size() / 4; ++i) {
        const float* p = &xyzi[4 * i];
        cloud->setPointFast(i, p[0], p[1], p[2]);
        cloud->setPointIntensity(i, p[3]);
    }
    return cloud;
}
}  // namespace

std::vector<float> xyziOf(const mrpt::maps::CPointsMap& points) {
    const auto* bright = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(&points);
    const auto& x = points.getPointsBufferRef_x();
    const auto& y = points.getPointsBufferRef_y();
    const auto& z = points.getPointsBufferRef_z();
    std::vector<float> xyzi(4 * x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        xyzi[4 * i] = x[i];
        xyzi[4 * i + 1] = y[i];
        xyzi[4 * i + 2] = z[i];
        xyzi[4 * i + 3] = bright ? bright->getPointIntensity(i) : 0.0F;
    }
    return xyzi;
}

RawlogWriter::RawlogWriter(const std::string& path, std::string label, bool embed, bool force)
    : path_(checked(path)),
      label_(std::move(label)),
      embed_(embed),
      lock_(path),
      partial_(folderOf(path), path),
      partialRawlog_((partial_.path() / fs::path(path).filename()).string()),
      partialImages_(sidecarPath(partialRawlog_, kImages)) {
    if (!force)
        for (const auto& output : outputsOf(path))
            if (fs::exists(output))
                throw Error("'" + output +
                            "' exists; choose another name, or overwrite it with --force");
    if (!embed_) makeImages();
    if (!out_.open(partialRawlog_)) giveUp();
}

std::vector<std::string> RawlogWriter::outputsOf(const std::string& path) {
    std::vector<std::string> outputs = {path, sidecarPath(path, kImages)};
    for (const char* extension : kSideFiles) outputs.push_back(sidecarPath(path, extension));
    return outputs;
}

void RawlogWriter::giveUp() const {
    throw Error("cannot write '" + path_ +
                "': the disk is full, or the folder is gone or not writable");
}

void RawlogWriter::makeImages() const {
    std::error_code fault;
    fs::create_directory(partialImages_, fault);
    if (fault) giveUp();
}

void RawlogWriter::write(const std::string& file, const void* bytes, std::size_t count) const {
    std::ofstream out(file, std::ios::binary);
    out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    out.close();
    if (!out) giveUp();
}

void RawlogWriter::add(double stamp_s, double epoch_s, const std::vector<float>& xyzi) {
    CObservationPointCloud observation;
    setPoints(observation, xyzi);
    append(observation, stamp_s, epoch_s);
}

void RawlogWriter::add(const Scan& scan, double epoch_s) {
    if (!scan.rings.empty()) addExtra(".ring", scan.rings);
    if (!scan.times_s.empty()) addExtra(".time", scan.times_s);
    CObservationPointCloud observation;
    observation.setSensorPose(toMrpt(scan.sensorPose));
    setPoints(observation, xyziOf(*scan.points));
    append(observation, scan.stamp_s, epoch_s);
}

void RawlogWriter::addOther(const std::string& label, const Scan& scan, double epoch_s) {
    const std::string own = std::exchange(label_, label);
    const auto count = std::exchange(count_, others_[label]++);
    prefix_ = label + "_";
    add(scan, epoch_s);
    prefix_.clear();
    label_ = own;
    count_ = count;
}

void RawlogWriter::addLinked(double stamp_s, double epoch_s, const std::string& file) {
    const std::string link = extraFile(".bin");
    std::error_code fault;
    fs::create_symlink(fs::absolute(file), link, fault);
    if (fault)
        throw Error("cannot write '" + path_ + "': a link to '" + file +
                    "' cannot be made: " + fault.message());
    CObservationPointCloud observation;
    setExternal(observation, link);
    append(observation, stamp_s, epoch_s);
}

void RawlogWriter::setPoints(CObservationPointCloud& observation, const std::vector<float>& xyzi) {
    if (embed_) {
        observation.pointcloud = cloudOf(xyzi);
        return;
    }
    addExtra(".bin", xyzi);
    setExternal(observation, extraFile(".bin"));
}

void RawlogWriter::append(CObservationPointCloud& observation, double stamp_s, double epoch_s) {
    observation.sensorLabel = label_;
    observation.timestamp = timeOf(stamp_s, epoch_s);
    put(observation);
    ++count_;
}

void RawlogWriter::add(const ImuSample& sample, double epoch_s) {
    auto observation = observationOf(sample);
    observation.sensorLabel = "imu";
    observation.timestamp = timeOf(sample.stamp_s - sample.offset_s.value_or(0), epoch_s);
    put(observation);
}

void RawlogWriter::add(const OdometrySample& sample, double epoch_s) {
    const auto observation = observationOf(sample);
    observation->sensorLabel = "odometry";
    observation->timestamp = timeOf(sample.stamp_s, epoch_s);
    put(*observation);
}

void RawlogWriter::put(const mrpt::obs::CObservation& observation) {
    try {
        mrpt::serialization::archiveFrom(out_) << observation;
    } catch (const std::exception&) {  // MRPT's words do not name the file
        giveUp();
    }
}

void RawlogWriter::add(const earth::Fix& fix, int quality, double epoch_s) {
    mrpt::obs::CObservationGPS observation;
    observation.sensorLabel = "gnss";
    observation.timestamp = timeOf(fix.stamp_s, epoch_s);
    observation.originalReceivedTimestamp = observation.timestamp;
    const Eigen::Vector3d antenna = fix.antenna.value_or(Eigen::Vector3d::Zero());
    observation.sensorPose = toMrpt(isometry(Eigen::Matrix3d::Identity(), antenna));
    mrpt::obs::gnss::Message_NMEA_GGA gga;
    const double time_s = std::fmod(epoch_s + fix.stamp_s, 86400);
    gga.fields.UTCTime.hour = static_cast<std::uint8_t>(time_s / 3600);
    gga.fields.UTCTime.minute = static_cast<std::uint8_t>(std::fmod(time_s, 3600) / 60);
    gga.fields.UTCTime.sec = std::fmod(time_s, 60);
    gga.fields.latitude_degrees = fix.place.latitude_deg;
    gga.fields.longitude_degrees = fix.place.longitude_deg;
    gga.fields.altitude_meters = fix.place.height_m;
    gga.fields.orthometric_altitude = fix.place.height_m;
    gga.fields.fix_quality = static_cast<std::uint8_t>(quality);
    gga.fields.thereis_HDOP = true;
    gga.fields.HDOP =
        static_cast<float>(std::sqrt(fix.covariance(0, 0) / earth::covarianceOf(quality, 1)(0, 0)));
    observation.setMsg(gga);
    try {
        mrpt::serialization::archiveFrom(out_) << observation;
    } catch (const std::exception&) {
        giveUp();
    }
}

void RawlogWriter::add(const earth::Fix& fix, double epoch_s) {
    // GGA has one number, and heights count as twice as uncertain.
    earth::Fix rounded = fix;
    const Eigen::Vector3d variances = fix.covariance.diagonal();
    rounded.covariance =
        std::max({variances.x(), variances.y(), variances.z() / 4}) * Eigen::Matrix3d::Identity();
    int best = 1;
    const auto off = [&](int quality) {
        return std::abs(std::log(rounded.covariance(0, 0) / earth::covarianceOf(quality, 1)(0, 0)));
    };
    for (const int quality : {2, 4, 5})
        if (off(quality) < off(best)) best = quality;
    add(rounded, best, epoch_s);
}

std::string RawlogWriter::extraFile(const std::string& extension) const {
    char name[32];
    std::snprintf(name, sizeof(name), "%06zu", count_);
    return (fs::path(partialImages_) / (prefix_ + name + extension)).string();
}

void RawlogWriter::finish(const DriveMeta& meta, const std::string& timesText,
                          const std::string& calibText, const std::string& posesText,
                          const std::string& faultsText, const std::string& originText,
                          const std::string& imuText, const std::string& gnssText) {
    // A full disk may show only now: everything that was handed over has to be in the file.
    const auto written = out_.getPosition();
    out_.close();
    std::error_code fault;
    if (fs::file_size(partialRawlog_, fault) != written || fault) giveUp();
    const auto writeText = [&](const char* extension, const std::string& text) {
        if (!text.empty()) write(sidecarPath(partialRawlog_, extension), text.data(), text.size());
    };
    writeText(".times.txt", timesText);
    writeText(".calib.txt", calibText);
    writeText(".poses.txt", posesText);
    writeText(".faults.tsv", faultsText);
    writeText(".origin.txt", originText);
    writeText(".imu.yaml", imuText);
    writeText(".gnss.csv", gnssText);
    writeText(".meta.yaml", textOf(meta));
    std::vector<std::string> names;  // the rawlog's first: it marks the whole
    for (const auto& output : outputsOf(path_)) names.push_back(fs::path(output).filename());
    partial_.putInPlace(names);
}
}  // namespace delio::io
