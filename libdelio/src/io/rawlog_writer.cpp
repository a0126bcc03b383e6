#include "delio/io/rawlog_writer.h"

#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/io/output_file.h"
#include "drive_clock.h"

namespace delio::io {
namespace fs = std::filesystem;
using mrpt::obs::CObservationPointCloud;

namespace {
const char* const kSideFiles[] = {".meta.yaml", ".times.txt",  ".calib.txt",
                                  ".poses.txt", ".faults.tsv", ".origin.txt"};

template <typename Value>
void writeValues(const std::string& path, const std::vector<Value>& values) {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(Value)));
    if (!out.flush()) throw Error("cannot write '" + path + "': is the disk full?");
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
    : path_(path), label_(std::move(label)), embed_(embed) {
    const fs::path target(path);
    if (target.extension() != ".rawlog")
        throw Error("'" + path + "' does not end in .rawlog; name the output OUT.rawlog");
    if (fs::is_directory(path))
        throw Error("'" + path + "' is a folder; choose another name for the rawlog");
    images_ = sidecarPath(path, "_Images");
    const std::string partial =
        (target.parent_path() / (".partial-" + target.stem().string())).string();
    partialRawlog_ = partial + ".rawlog";
    partialImages_ = partial + "_Images";
    if (!force) {
        std::vector<std::string> outputs = {path_, images_};
        for (const char* extension : kSideFiles) outputs.push_back(sidecarPath(path, extension));
        for (const auto& output : outputs)
            if (fs::exists(output))
                throw Error("'" + output +
                            "' exists; choose another name, or overwrite it with --force");
    }
    std::error_code fault;
    fs::remove_all(partialImages_, fault);
    if (!out_.open(partialRawlog_))
        throw Error("cannot write '" + path + "': the folder does not exist or is not writable");
    if (!embed_ && !fs::create_directory(partialImages_, fault))
        throw Error("cannot make the folder '" + images_ + "': " + fault.message());
}

RawlogWriter::~RawlogWriter() {
    if (finished_) return;
    out_.close();
    std::error_code ignored;
    fs::remove(partialRawlog_, ignored);
    fs::remove_all(partialImages_, ignored);
}

void RawlogWriter::add(double stamp_s, double epoch_s, const std::vector<float>& xyzi) {
    CObservationPointCloud observation;
    setPoints(observation, xyzi);
    append(observation, stamp_s, epoch_s);
}

void RawlogWriter::add(const Scan& scan, double epoch_s) {
    if (!scan.rings.empty()) writeValues(extraFile(".ring"), scan.rings);
    if (!scan.times_s.empty()) writeValues(extraFile(".time"), scan.times_s);
    CObservationPointCloud observation;
    observation.setSensorPose(toMrpt(scan.sensorPose));
    setPoints(observation, xyziOf(*scan.points));
    append(observation, scan.stamp_s, epoch_s);
}

void RawlogWriter::addLinked(double stamp_s, double epoch_s, const std::string& file) {
    const std::string link = extraFile(".bin");
    std::error_code fault;
    fs::create_symlink(fs::absolute(file), link, fault);
    if (fault) throw Error("cannot link '" + link + "' to '" + file + "': " + fault.message());
    CObservationPointCloud observation;
    setExternal(observation, link);
    append(observation, stamp_s, epoch_s);
}

void RawlogWriter::setPoints(CObservationPointCloud& observation, const std::vector<float>& xyzi) {
    if (embed_) {
        observation.pointcloud = cloudOf(xyzi);
        return;
    }
    const std::string file = extraFile(".bin");
    writeValues(file, xyzi);
    setExternal(observation, file);
}

void RawlogWriter::append(CObservationPointCloud& observation, double stamp_s, double epoch_s) {
    observation.sensorLabel = label_;
    observation.timestamp = timeOf(stamp_s, epoch_s);
    mrpt::serialization::archiveFrom(out_) << observation;
    ++count_;
}

std::string RawlogWriter::extraFile(const std::string& extension) {
    fs::create_directories(partialImages_);
    char name[32];
    std::snprintf(name, sizeof(name), "%06zu", count_);
    return (fs::path(partialImages_) / (name + extension)).string();
}

void RawlogWriter::finish(const DriveMeta& meta, const std::string& timesText,
                          const std::string& calibText, const std::string& posesText,
                          const std::string& faultsText, const std::string& originText) {
    // A full disk may show only now: everything that was handed over has to be in the file.
    const auto written = out_.getPosition();
    out_.close();
    if (fs::file_size(partialRawlog_) != written)
        throw Error("cannot write '" + path_ + "': is the disk full?");
    const auto writeText = [&](const char* extension, const std::string& text) {
        const std::string file = sidecarPath(path_, extension);
        if (text.empty())
            fs::remove(file);  // of a drive that was here before
        else
            replaceTextFile(file, [&](std::ostream& out) { out << text; });
    };
    writeText(".times.txt", timesText);
    writeText(".calib.txt", calibText);
    writeText(".poses.txt", posesText);
    writeText(".faults.tsv", faultsText);
    writeText(".origin.txt", originText);
    writeDriveMeta(meta, path_);
    std::error_code fault;
    fs::remove_all(images_, fault);
    if (fs::exists(partialImages_)) fs::rename(partialImages_, images_, fault);
    if (!fault) fs::rename(partialRawlog_, path_, fault);
    if (fault) throw Error("cannot write '" + path_ + "': " + fault.message());
    finished_ = true;
}
}  // namespace delio::io
