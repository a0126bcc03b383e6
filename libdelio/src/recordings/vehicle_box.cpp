#include "vehicle_box.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "formats/number_line.h"
#include "scan_points.h"

namespace delio::io {
namespace {
constexpr double kDegree = M_PI / 180, kTurn_deg = 360;

bool isSector(const VehiclePart& part) { return part.box.isEmpty(); }

/** From one azimuth to the next, 0 to 360 deg. */
double width_deg(double from_deg, double to_deg) {
    const double width = std::fmod(to_deg - from_deg, kTurn_deg);
    return width < 0 ? width + kTurn_deg : width;
}

/** `point`: in the sensor's frame. */
bool isInSector(const VehiclePart& part, const Eigen::Vector3d& point) {
    const double elevation = std::atan2(point.z(), point.head<2>().norm()) / kDegree;
    if (!(elevation >= part.elevationFrom_deg && elevation <= part.elevationTo_deg)) return false;
    if (point.norm() > part.range_m) return false;
    const double azimuth = std::atan2(point.y(), point.x()) / kDegree;
    return part.azimuthTo_deg - part.azimuthFrom_deg >= kTurn_deg ||
           width_deg(part.azimuthFrom_deg, azimuth) <=
               width_deg(part.azimuthFrom_deg, part.azimuthTo_deg);
}

/** Finite numbers; empty where one is not. */
std::vector<double> numbersOf(std::vector<std::string_view> words) {
    std::vector<double> numbers;
    for (const auto word : words) {
        const auto number = numberIn<double>(word);
        if (!number || !std::isfinite(*number)) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

/** The box of six words; empty where they are something else. */
Eigen::AlignedBox3d boxOf(const std::vector<std::string_view>& words) {
    const auto numbers = numbersOf(words);
    if (numbers.size() != 6) return {};
    return {Eigen::Vector3d(numbers.data()), Eigen::Vector3d(numbers.data() + 3)};
}

VehiclePart sectorOf(std::vector<std::string_view> words) {
    VehiclePart part;
    if (words.size() == 6) {
        part.sensor = words.back();
        words.pop_back();
    }
    const auto numbers = numbersOf(words);
    const bool isComplete = numbers.size() == 4 || numbers.size() == 5;
    if (!isComplete || numbers[2] > numbers[3] || (numbers.size() == 5 && numbers[4] <= 0))
        throw Error(
            "expected sector azimuth_from azimuth_to elevation_from elevation_to [range_max "
            "[sensor]] (degrees and metres)");
    part.azimuthFrom_deg = numbers[0];
    part.azimuthTo_deg = numbers[1];
    part.elevationFrom_deg = numbers[2];
    part.elevationTo_deg = numbers[3];
    if (numbers.size() == 5) part.range_m = numbers[4];
    return part;
}

VehiclePart partIn(std::vector<std::string_view> words) {
    const std::string_view kind = words.front();
    words.erase(words.begin());
    if (kind == "sector") return sectorOf(words);
    const auto box = kind == "box" ? boxOf(words) : Eigen::AlignedBox3d();
    if (box.isEmpty())
        throw Error("expected box xmin ymin zmin xmax ymax zmax (metres), or sector ...");
    return {box};
}

std::vector<VehiclePart> readParts(const std::string& path) {
    const SideFile file = sideFile(path);
    std::vector<VehiclePart> parts;
    std::string_view rest = file.text;
    std::size_t number = 0;
    while (const auto line = nextLine(rest, &number)) {
        const auto words = wordsIn(line->substr(0, line->find('#')));
        if (words.empty()) continue;
        const auto where = "'" + path + "', line " + std::to_string(number);
        try {
            parts.push_back(partIn(words));
        } catch (const Error& e) {
            throw Error(where + ": " + e.what());
        }
        parts.back().name = where;
    }
    if (parts.empty()) throw Error("'" + path + "' has no box and no sector");
    return parts;
}

template <typename IsWanted>
std::vector<VehiclePart> only(const std::vector<VehiclePart>& parts, const IsWanted& isWanted) {
    std::vector<VehiclePart> wanted;
    std::copy_if(parts.begin(), parts.end(), std::back_inserter(wanted), isWanted);
    return wanted;
}
}  // namespace

std::vector<VehiclePart> vehiclePartsIn(const std::string& text) {
    VehiclePart part{boxOf(wordsIn(text))};
    std::error_code ignored;
    if (isSector(part) && std::filesystem::exists(text, ignored)) return readParts(text);
    if (isSector(part))
        throw Error(
            "--vehicle-box needs XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX (metres in the vehicle frame) or a "
            "file with boxes and sectors, not '" +
            text + "'");
    part.name = "the vehicle box";
    return {part};
}

std::optional<Scan> WithoutVehicle::next() {
    const auto scan = source_->next();
    if (!scan) return scan;
    ++scans_;
    const auto isIn = [&](const VehiclePart& part, const Eigen::Vector3d& point) {
        if (!isSector(part)) return part.box.contains(scan->sensorPose * point);
        return (part.sensor.empty() || part.sensor == label()) && isInSector(part, point);
    };
    return partOf(*scan, [&](std::size_t i) {
        Eigen::Vector3f point;
        scan->points->getPointFast(i, point.x(), point.y(), point.z());
        bool isInside = false;
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            if (!isIn(parts_[k], point.cast<double>())) continue;
            ++inside_[k];
            isInside = true;
        }
        return !isInside;
    });
}

Recording WithoutVehicle::recording() const {
    Recording recording = source_->recording();
    for (std::size_t k = 0; k < parts_.size() && scans_ > 0; ++k)
        if (inside_[k] == 0)
            recording.findings.push_back("no point of any scan lies in " + parts_[k].name +
                                         (isSector(parts_[k])
                                              ? ": it is given in degrees, in the sensor's frame"
                                              : ": it is given in metres, in the vehicle's frame"));
    return recording;
}

std::unique_ptr<ScanReader> without(std::vector<VehiclePart> parts,
                                    std::unique_ptr<ScanReader> source) {
    if (parts.empty()) return source;
    return std::make_unique<WithoutVehicle>(std::move(source), std::move(parts));
}

std::vector<VehiclePart> boxesOf(const std::vector<VehiclePart>& parts) {
    return only(parts, [](const VehiclePart& part) { return !isSector(part); });
}

std::vector<VehiclePart> sectorsOf(const std::vector<VehiclePart>& parts,
                                   const std::string& label) {
    return only(parts, [&](const VehiclePart& part) {
        return isSector(part) && (label.empty() || part.sensor.empty() || part.sensor == label);
    });
}
}  // namespace delio::io
