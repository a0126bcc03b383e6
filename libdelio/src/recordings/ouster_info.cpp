#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "delio/core/error.h"
#include "files/input_file.h"
#include "ouster.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
using Json = nlohmann::json;
constexpr double kMetresPerMm = 1e-3;
constexpr std::size_t kMostRows = 1024;
const char* const kLegacy = "LEGACY";

/** Of the first return; the second one of two lies behind it. */
struct Profile {
    const char* name;
    std::size_t pixel;           //!< bytes
    bool isCoarse;               //!< ranges have 15 bits, of 8 mm, not 19 bits of 1 mm
    std::size_t reflectivityAt;  //!< bytes
};
constexpr std::array<Profile, 13> kProfiles{{
    {"LEGACY", 12, false, 4},
    {"RNG15_RFL8_NIR8", 4, true, 2},
    {"RNG15_RFL8_WIN8", 4, true, 2},
    {"RNG15_RFL8_NIR8_DUAL", 8, true, 2},
    {"FUSA_RNG15_RFL8_NIR8_DUAL", 8, true, 2},
    {"RNG15_RFL8_NIR8_ZONE16", 8, true, 2},
    {"RNG19_RFL8_SIG16_NIR16", 12, false, 4},
    {"RNG19_RFL8_SIG16_NIR16_ZONE16", 12, false, 4},
    {"RNG19_RFL8_SIG16_NIR16_DUAL", 16, false, 3},
    {"RNG19_RFL8_SIG16_ZONE16_DUAL", 16, false, 3},
    {"RNG19_RFL8_SIG16_NIR16_RGB16", 16, false, 3},
    {"RNG19_RFL8_SIG16_NIR16_RGB16_DUAL", 20, false, 3},
    {"FIVE_WORD_PIXEL", 20, false, 3},
}};

std::optional<OusterLayout> layoutOf(const std::string& name) {
    if (name == kLegacy) return OusterLayout{0, 0, 16, 4, 12, true, false, 4, 0xFFFFF, 1, 4, 2};
    const auto profile = std::find_if(kProfiles.begin(), kProfiles.end(),
                                      [&](const Profile& one) { return name == one.name; });
    if (profile == kProfiles.end()) return {};
    OusterLayout layout{32, 32, 12, 0, profile->pixel};
    layout.safety = name.rfind("FUSA_", 0) == 0;
    layout.rangeBytes = profile->isCoarse ? 2 : 4;
    layout.rangeMask = profile->isCoarse ? 0x7FFF : 0x7FFFF;
    layout.rangeUnit_mm = profile->isCoarse ? 8 : 1;
    layout.reflectivityAt = profile->reflectivityAt;
    return layout;
}

std::string supportedProfiles() {
    std::string names;
    for (const Profile& profile : kProfiles)
        names += (names.empty() ? "" : ", ") + std::string(profile.name);
    return names;
}

/** Reads keys at the top level or in one of several groups. */
class Reader {
 public:
    Reader(const std::string& text, const std::string& name) : name_(name) {
        try {
            root_ = Json::parse(text);
        } catch (const Json::exception&) {
            throw Error("'" + name_ + "' is not valid JSON");
        }
        if (!root_.is_object()) throw Error("'" + name_ + "' is not an Ouster metadata json");
    }

    [[noreturn]] void refuse(const std::string& key, const std::string& fault) const {
        throw Error("'" + name_ + "': " + key + " " + fault);
    }

    template <typename Value>
    std::optional<Value> find(const std::string& key) const {
        const Json* const json = lookUp(key);
        if (!json || json->is_null()) return {};
        try {
            return json->get<Value>();
        } catch (const Json::exception&) {
            refuse(key, "has the wrong type");
        }
    }

    /** A number, or a text with a number; 0 if it is missing. */
    std::uint64_t idOf(const std::string& key) const {
        const Json* const json = lookUp(key);
        if (json && json->is_number_unsigned()) return json->get<std::uint64_t>();
        std::uint64_t id = 0;
        if (!json || !json->is_string()) return id;
        const auto text = json->get<std::string>();
        const char* const end = text.data() + text.size();
        return std::from_chars(text.data(), end, id).ptr == end ? id : 0;
    }

    template <typename Value>
    Value get(const std::string& key) const {
        auto value = find<Value>(key);
        if (!value) refuse(key, "is missing: not an Ouster metadata json");
        return *value;
    }

 private:
    const Json* lookUp(const std::string& key) const {
        if (root_.contains(key)) return &root_.at(key);
        for (const char* const group :
             {"data_format", "lidar_data_format", "beam_intrinsics", "lidar_intrinsics",
              "sensor_info", "config_params", "imu_intrinsics", "imu_data_format"})
            if (root_.contains(group) && root_.at(group).is_object() &&
                root_.at(group).contains(key))
                return &root_.at(group).at(key);
        return nullptr;
    }

    std::string name_;
    Json root_;
};

std::vector<double> anglesOf(const Reader& reader, const std::string& key) {
    auto angles = reader.get<std::vector<double>>(key);
    for (double& angle : angles) angle *= M_PI / 180;
    return angles;
}

/** A number of the file may be one that no whole number can hold, and is read as a double first. */
std::size_t countOf(const Reader& reader, const std::string& key, double most) {
    const auto count = reader.get<double>(key);
    if (!(count >= 1 && count <= most)) reader.refuse(key, "is out of range");
    return static_cast<std::size_t>(count);
}

/** Whole numbers from `least` to `most`; nothing where the key is missing. */
std::optional<std::vector<int>> wholeNumbersOf(const Reader& reader, const std::string& key,
                                               double least, double most) {
    const auto values = reader.find<std::vector<double>>(key);
    if (!values) return {};
    std::vector<int> numbers;
    for (const double value : *values) {
        if (!(value >= least && value <= most)) reader.refuse(key, "is out of range");
        numbers.push_back(static_cast<int>(value));
    }
    return numbers;
}

/** "1024x10": columns and turns a second. */
std::size_t columnsOf(const Reader& reader) {
    const auto mode = reader.get<std::string>("lidar_mode");
    for (const std::size_t columns : {512U, 1024U, 2048U, 4096U})
        if (mode.rfind(std::to_string(columns) + "x", 0) == 0) return columns;
    reader.refuse("lidar_mode", "is not supported: '" + mode + "'");
}

std::optional<Eigen::Matrix4d> matrixOf(const Reader& reader, const std::string& key) {
    const auto values = reader.find<std::vector<double>>(key);
    if (!values) return {};
    if (values->size() != 16) reader.refuse(key, "is not a matrix of 4 by 4");
    Eigen::Matrix4d matrix =
        Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values->data());
    matrix.topRightCorner<3, 1>() *= kMetresPerMm;
    return matrix;
}

double usualBeamOut_mm(const std::string& product) {
    if (product.rfind("OS-0-", 0) == 0) return 27.67;
    if (product.rfind("OS-1-", 0) == 0) return 15.806;
    if (product.rfind("OS-2-", 0) == 0) return 13.762;
    return 12.163;
}

void readBeams(const Reader& reader, OusterInfo& info) {
    info.elevations = anglesOf(reader, "beam_altitude_angles");
    info.azimuths = anglesOf(reader, "beam_azimuth_angles");
    if (info.elevations.empty()) reader.refuse("beam_altitude_angles", "is empty");
    if (info.elevations.size() > kMostRows) reader.refuse("beam_altitude_angles", "is too long");
    if (info.azimuths.size() != info.elevations.size())
        reader.refuse("beam_azimuth_angles", "has another length than beam_altitude_angles");
    info.beamOut_m = kMetresPerMm * reader.find<double>("lidar_origin_to_beam_origin_mm")
                                        .value_or(usualBeamOut_mm(info.product));
    if (const auto beam = matrixOf(reader, "beam_to_lidar_transform")) {
        info.beamOut_m = (*beam)(0, 3);
        info.beamUp_m = (*beam)(2, 3);
    }
    Eigen::Matrix4d usual = Eigen::Matrix4d::Identity();
    usual(0, 0) = usual(1, 1) = -1;
    usual(2, 3) = 36.18 * kMetresPerMm;
    info.lidarToSensor = matrixOf(reader, "lidar_to_sensor_transform").value_or(usual);
    usual = Eigen::Matrix4d::Identity();
    usual.topRightCorner<3, 1>() = kMetresPerMm * Eigen::Vector3d(6.253, -11.775, 7.645);
    info.imuToSensor = matrixOf(reader, "imu_to_sensor_transform").value_or(usual);
    constexpr double kMostSamples = 1000;  // in a packet
    const auto samples = reader.find<double>("imu_measurements_per_packet").value_or(0);
    if (samples >= 1 && samples <= kMostSamples)
        info.imuSamples = static_cast<std::size_t>(samples);
}

void readColumns(const Reader& reader, OusterInfo& info) {
    constexpr double kMost = 4096;
    const bool isGiven = reader.find<Json>("columns_per_frame").has_value();
    info.columns = isGiven ? countOf(reader, "columns_per_frame", kMost) : columnsOf(reader);
    if (reader.find<Json>("columns_per_packet"))
        info.columnsPerPacket = countOf(reader, "columns_per_packet", kMost);
    info.columnsUsed = info.columns;
    const auto columns = static_cast<int>(info.columns);
    const auto window = wholeNumbersOf(reader, "column_window", 0, columns - 1);
    if (!window) return;
    if (window->size() != 2) reader.refuse("column_window", "does not hold two valid columns");
    info.columnsUsed =
        static_cast<std::size_t>((window->at(1) - window->at(0) + columns) % columns + 1);
}
}  // namespace

OusterInfo readOusterInfo(const std::string& json, const std::string& name) {
    const Reader reader(json, name);
    OusterInfo info;
    info.product = reader.find<std::string>("prod_line").value_or("");
    info.ids = {reader.idOf("prod_sn"),
                static_cast<std::uint32_t>(reader.idOf("initialization_id"))};
    readBeams(reader, info);
    info.rows = info.elevations.size();
    if (reader.find<Json>("pixels_per_column") &&
        countOf(reader, "pixels_per_column", kMostRows) != info.rows)
        reader.refuse("beam_altitude_angles", "does not match pixels_per_column");
    readColumns(reader, info);
    const auto columns = static_cast<double>(info.columns);
    info.pixelShifts = wholeNumbersOf(reader, "pixel_shift_by_row", -columns, columns)
                           .value_or(std::vector<int>{});
    if (!info.pixelShifts.empty() && info.pixelShifts.size() != info.rows)
        reader.refuse("pixel_shift_by_row", "does not match the number of beams");
    const auto profile = reader.find<std::string>("udp_profile_lidar").value_or(kLegacy);
    const auto layout = layoutOf(profile);
    if (!layout)
        reader.refuse("udp_profile_lidar",
                      "is not supported: '" + profile + "'; supported are " + supportedProfiles());
    info.layout = *layout;
    if (const auto header = reader.find<std::string>("header_type"); header && !layout->legacy)
        info.layout.safety = *header == "FUSA";
    return info;
}

bool isOusterPacketSize(std::size_t bytes) {
    for (const Profile& profile : kProfiles)
        for (const std::size_t rows : {16U, 32U, 64U, 128U})
            for (const std::size_t columns : {4U, 8U, 16U}) {
                OusterInfo info;
                info.rows = rows;
                info.columnsPerPacket = columns;
                info.layout = *layoutOf(profile.name);
                if (info.packetBytes() == bytes) return true;
            }
    return false;
}

namespace {
bool fits(const SideFile& json, const std::uint8_t* packet, std::size_t bytes) {
    try {
        const OusterInfo info = readOusterInfo(json.text, json.name);
        return info.packetBytes() == bytes && info.ids.fit(OusterPacket(info, packet).ids());
    } catch (const Error&) {
        return false;
    }
}

/** Those that name beams, by name. */
std::vector<SideFile> descriptionsIn(const fs::path& folder) {
    constexpr std::uintmax_t kMostBytes = 1 << 20;
    std::vector<SideFile> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        if (entry.path().extension() != ".json" || !entry.is_regular_file() ||
            entry.file_size() > kMostBytes)
            continue;
        SideFile json = sideFile(entry.path().string());
        if (json.text.find("beam_altitude_angles") != std::string::npos)
            found.push_back(std::move(json));
    }
    std::sort(found.begin(), found.end(),
              [](const SideFile& one, const SideFile& other) { return one.name < other.name; });
    return found;
}

void keepMostAlike(std::vector<SideFile>& jsons, const std::string& stem) {
    const auto likeness = [&](const SideFile& json) {
        return inCommon(fs::path(json.name).stem().string(), stem);
    };
    std::size_t most = 0;
    for (const SideFile& json : jsons) most = std::max(most, likeness(json));
    jsons.erase(std::remove_if(jsons.begin(), jsons.end(),
                               [&](const SideFile& json) { return likeness(json) < most; }),
                jsons.end());
}

std::string listed(const std::vector<SideFile>& jsons) {
    constexpr std::size_t kMost = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(kMost, jsons.size()); ++i)
        text += (i > 0 ? ", '" : "'") + jsons[i].name + "'";
    return text + (jsons.size() > kMost ? ", ..." : "");
}
}  // namespace

std::size_t inCommon(const std::string& one, const std::string& other) {
    const auto differ = std::mismatch(one.begin(), one.end(), other.begin(), other.end());
    return static_cast<std::size_t>(differ.first - one.begin());
}

SideFile ousterJsonBeside(const std::string& recording, const std::uint8_t* packet,
                          std::size_t bytes) {
    fs::path file = recording;
    if (!file.has_filename()) file = file.parent_path();  // DRIVE/
    const std::string stem = file.stem().string();
    const fs::path own = fs::path(file).replace_extension(".json");
    if (fs::is_regular_file(own)) return sideFile(own.string());
    const auto all = descriptionsIn(file.has_parent_path() ? file.parent_path() : ".");
    auto fitting = all;
    if (packet)
        fitting.erase(
            std::remove_if(fitting.begin(), fitting.end(),
                           [&](const SideFile& json) { return !fits(json, packet, bytes); }),
            fitting.end());
    // If none fits, the most similar one gives the error message.
    if (fitting.empty()) fitting = all;
    keepMostAlike(fitting, stem);
    if (fitting.size() == 1) return fitting.front();
    throw Error(
        "contains Ouster packets, which need the sensor's metadata: '" + own.string() +
        "' not found" +
        (fitting.empty() ? "" : ", and several other files could be it: " + listed(fitting)) +
        "; choose one with --sensor-info FILE.json");
}
}  // namespace delio::io
