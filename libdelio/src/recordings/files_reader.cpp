#include "files_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/mrpt/rawlog_writer.h"
#include "files/input_file.h"
#include "formats/number_line.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
const char* const kTimesFiles[] = {"times.txt", "timestamps.txt", "times.csv"};
constexpr double kFirstUnix_s = 5e8, kLastUnix_s = 5e9;  // 1985 to 2128

/** Ticks a second of times that are Unix times: as many as make them one of our days. */
double ticksOfUnix(double time) {
    for (const double ticks : {1.0, 1e3, 1e6, 1e9})
        if (time >= kFirstUnix_s * ticks && time <= kLastUnix_s * ticks) return ticks;
    return 0;
}

/** Ticks a second of times that start anywhere: scans are 10 ms to 10 s apart. */
double ticksOf(const std::vector<double>& times) {
    if (times.empty()) return 1;
    const double unix = ticksOfUnix(times.front());
    if (unix > 0) return unix;
    if (times.size() < 2) return 1;
    const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    for (const double ticks : {1.0, 1e3, 1e6})
        if (step < 10 * ticks) return ticks;
    return 1e9;
}

/** Seconds of a whole number of ticks, to the last digit that a double has. */
double secondsOf(std::string_view text, double ticks) {
    const auto whole = numberIn<std::uint64_t>(text);
    if (!whole || ticks == 1) return *numberIn<double>(text) / ticks;
    const auto unit = static_cast<std::uint64_t>(ticks);
    const std::uint64_t seconds = *whole / unit;
    return static_cast<double>(seconds) + static_cast<double>(*whole % unit) / ticks;
}

std::vector<double> readTimesFile(const fs::path& file) {
    const auto bytes = bytesOfFile(file);
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<double> dates, numbers;
    std::vector<std::string_view> words;
    std::size_t row = 0;
    while (const auto line = nextLine(rest, &row)) {
        if (line->front() == '#') continue;
        const auto found = wordsIn(*line);
        const auto number = found.size() == 1 ? numberIn<double>(found[0]) : std::nullopt;
        if (number && std::isfinite(*number) && dates.empty()) {
            words.push_back(found[0]);
            numbers.push_back(*number);
            continue;
        }
        const auto date = number ? std::nullopt : unixTimeOfDate(std::string(*line));
        if (!date || !words.empty())
            throw Error("'" + file.string() + "', line " + std::to_string(row) +
                        ": expected a time in seconds, or a date and time like the other lines");
        dates.push_back(*date);
    }
    if (!dates.empty()) return dates;
    const double ticks = ticksOf(numbers);
    for (std::size_t i = 0; i < words.size(); ++i) numbers[i] = secondsOf(words[i], ticks);
    return numbers;
}

/** The first file of these names in the folder or the one above. */
std::optional<fs::path> firstFileOf(const fs::path& folder, const std::vector<std::string>& names) {
    for (const auto& place : {folder, fs::absolute(folder / "").parent_path().parent_path()})
        for (const auto& name : names)
            if (fs::is_regular_file(place / name)) return place / name;
    return {};
}

/** The Unix time that a file is named after. */
std::optional<double> unixTimeOfName(const fs::path& file) {
    std::string stem = file.stem().string();
    // 1616513421.123456.pcd.bin, as nuScenes names its scans.
    if (fs::path(stem).extension() == ".pcd") stem = fs::path(stem).stem().string();
    const auto digits = stem.find_first_not_of("0123456789");
    if (digits != stem.npos && stem[digits] == '_') stem[digits] = '.';
    if (stem.find_first_not_of("0123456789.") != stem.npos) return {};
    const auto number = numberIn<double>(stem);
    const double ticks = number ? ticksOfUnix(*number) : 0;
    if (ticks == 0 || (ticks != 1 && digits != stem.npos)) return {};
    return secondsOf(stem, ticks);
}

/** Sorts `scans` by the times of their names; empty where not all have one. */
std::vector<double> timesOfNames(std::vector<fs::path>& scans) {
    std::vector<std::pair<double, fs::path>> timed;
    for (const auto& scan : scans) {
        const auto time = unixTimeOfName(scan);
        if (!time) return {};
        timed.emplace_back(*time, scan);
    }
    std::sort(timed.begin(), timed.end());
    std::vector<double> times;
    for (std::size_t i = 0; i < timed.size(); ++i) {
        times.push_back(timed[i].first);
        scans[i] = timed[i].second;
    }
    return times;
}
}  // namespace

bool isTimesFile(const fs::path& file) {
    return std::find(std::begin(kTimesFiles), std::end(kTimesFiles), file.filename().string()) !=
           std::end(kTimesFiles);
}

std::vector<ImuSample> imuBeside(const fs::path& folder) {
    const auto file = firstFileOf(folder, {"imu.csv"});
    if (!file) return {};
    const auto bytes = bytesOfFile(*file);
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<ImuSample> samples;
    std::size_t row = 0;
    double ticks = 0;
    while (const auto line = nextLine(rest, &row)) {
        if (line->front() == '#') continue;
        constexpr std::size_t kRate = 4, kBoth = 7;
        std::vector<double> values(kBoth);
        const std::size_t count = numbersIn(*line, values);
        if (count == kNoNumbers && samples.empty()) continue;  // names of the columns
        if ((count != kRate && count != kBoth) || !std::isfinite(values[0]))
            throw Error("'" + file->string() + "', line " + std::to_string(row) +
                        ": expected time, angular velocity (x y z, rad/s) and optionally "
                        "acceleration (x y z, m/s^2)");
        if (samples.empty()) ticks = std::max(1.0, ticksOfUnix(values[0]));
        ImuSample sample;
        const auto word = wordsIn(*line).front();
        sample.stamp_s = numberIn<double>(word) ? secondsOf(word, ticks) : values[0] / ticks;
        sample.rate_radps = Eigen::Vector3d(values[1], values[2], values[3]);
        if (count == kBoth)
            sample.acceleration_mps2 = Eigen::Vector3d(values[4], values[5], values[6]);
        samples.push_back(sample);
    }
    std::stable_sort(samples.begin(), samples.end(),
                     [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
    return samples;
}

ScanTimes timesOf(const fs::path& folder, std::vector<fs::path>& scans) {
    ScanTimes times;
    if (const auto file = firstFileOf(folder, {std::begin(kTimesFiles), std::end(kTimesFiles)})) {
        times.stamps_s = readTimesFile(*file);
        if (times.stamps_s.size() != scans.size())
            throw Error("'" + file->string() + "' has " + std::to_string(times.stamps_s.size()) +
                        " times, but there are " + std::to_string(scans.size()) + " scans in '" +
                        folder.string() + "'; complete or remove the file");
    } else {
        times.stamps_s = timesOfNames(scans);
        times.nominal = times.stamps_s.empty();
        if (times.nominal)
            for (std::size_t i = 0; i < scans.size(); ++i)
                times.stamps_s.push_back(0.1 * static_cast<double>(i));
    }
    if (times.stamps_s.front() < kFirstUnix_s) times.epoch_s = kDriveEpoch_s;
    return times;
}

std::optional<Scan> FilesReader::next() {
    if (count_ >= files().size()) return {};
    const std::size_t index = count_;
    count_ = files().size();  // should it fail
    Scan scan = read(index);
    scan.index = index;
    latest_s_ = scan.stamp_s;
    count_ = index + 1;
    return scan;
}

/** Those up to half a second after the latest scan. */
std::vector<ImuSample> FilesReader::takeImu() {
    constexpr double kAhead_s = 0.5;
    std::vector<ImuSample> taken;
    const bool isEnd = count_ >= files().size();
    for (; takenImu_ < imu_.size(); ++takenImu_) {
        if (!isEnd && imu_[takenImu_].stamp_s > latest_s_ + kAhead_s) break;
        taken.push_back(imu_[takenImu_]);
    }
    return taken;
}

bool FilesReader::skip() {
    if (count_ >= files().size()) return false;
    ++count_;
    return true;
}

std::optional<double> FilesReader::fraction() const {
    return static_cast<double>(count_) / static_cast<double>(files().size());
}
}  // namespace delio::io
