#include "delio/formats/georeference.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "files/input_file.h"
#include "number_line.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
constexpr double kDay_s = 86400;
constexpr double kFirstUnix_s = 5e8, kLastUnix_s = 5e9;

/** Columns of a csv by their names; -1: missing. */
struct CsvColumns {
    int time = -1, latitude = -1, longitude = -1, height = -1, east = -1, north = -1, up = -1,
        quality = -1, hdop = -1;
};

CsvColumns columnsOf(const std::vector<std::string>& names) {
    CsvColumns columns;
    const std::map<std::string, int*> known{{"time", &columns.time},
                                            {"stamp", &columns.time},
                                            {"stamp_s", &columns.time},
                                            {"timestamp", &columns.time},
                                            {"latitude", &columns.latitude},
                                            {"lat", &columns.latitude},
                                            {"latitude_deg", &columns.latitude},
                                            {"longitude_deg", &columns.longitude},
                                            {"longitude", &columns.longitude},
                                            {"lon", &columns.longitude},
                                            {"height", &columns.height},
                                            {"altitude", &columns.height},
                                            {"alt", &columns.height},
                                            {"height_m", &columns.height},
                                            {"sigma_east", &columns.east},
                                            {"sigma_north", &columns.north},
                                            {"sigma_up", &columns.up},
                                            {"sigma_east_m", &columns.east},
                                            {"sigma_north_m", &columns.north},
                                            {"sigma_up_m", &columns.up},
                                            {"quality", &columns.quality},
                                            {"hdop", &columns.hdop}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto found = known.find(lowerCase(names[i]));
        if (found != known.end() && *found->second < 0) *found->second = static_cast<int>(i);
    }
    return columns;
}

/** Unix times in other units become seconds. */
double secondsOf(double time) {
    for (const double ticks : {1.0, 1e3, 1e6, 1e9})
        if (time >= kFirstUnix_s * ticks && time <= kLastUnix_s * ticks) return time / ticks;
    return time;
}

earth::Fix fixOfCells(const CsvColumns& columns, const std::vector<std::string>& cells,
                      const std::string& where) {
    const auto numberOf = [&](int column) -> std::optional<double> {
        if (column < 0 || static_cast<std::size_t>(column) >= cells.size()) return {};
        const std::string& cell = cells[static_cast<std::size_t>(column)];
        if (cell.empty()) return {};
        const auto number = numberIn<double>(cell);
        if (!number) throw Error(where + ": '" + cell + "' is not a number");
        return number;
    };
    // Not a number: not known, as in a NavSatFix.
    const auto knownOf = [&](int column) {
        const auto number = numberOf(column);
        return number && std::isfinite(*number) ? number : std::nullopt;
    };
    earth::Fix fix;
    const auto time = numberOf(columns.time), lat = numberOf(columns.latitude),
               lon = numberOf(columns.longitude), height = knownOf(columns.height);
    if (!time || !lat || !lon) throw Error(where + ": time, latitude or longitude is missing");
    fix.stamp_s = secondsOf(*time);
    fix.place = {*lat, *lon, height.value_or(0)};
    const double quality = std::clamp(knownOf(columns.quality).value_or(1), 0.0, 9.0);
    fix.covariance =
        earth::covarianceOf(static_cast<int>(quality), knownOf(columns.hdop).value_or(0));
    const int sigmas[] = {columns.east, columns.north, columns.up};
    for (int axis = 0; axis < 3; ++axis)
        if (const auto sigma = knownOf(sigmas[axis]); sigma && *sigma > 0)
            fix.covariance(axis, axis) = *sigma * *sigma;
    constexpr double kUnknown_m = 1e3;
    if (!height) fix.covariance(2, 2) = kUnknown_m * kUnknown_m;
    return fix;
}

earth::Fixes fixesOfCsv(const fs::path& file, std::string_view rest) {
    earth::Fixes fixes;
    std::optional<CsvColumns> columns;
    std::size_t row = 0;
    while (const auto line = nextLine(rest, &row)) {
        if (line->front() == '#') continue;
        const auto cells = cellsIn(*line);
        const std::string where = "'" + file.string() + "', line " + std::to_string(row);
        if (columns) {
            fixes.push_back(fixOfCells(*columns, cells, where));
            continue;
        }
        columns = columnsOf(cells);
        if (columns->time < 0 || columns->latitude < 0 || columns->longitude < 0)
            throw Error(where + ": the header must name time, latitude and longitude");
    }
    return fixes;
}

/** The words of a sentence whose checksum, where it has one, is right; else empty. */
std::vector<std::string> sentenceIn(std::string_view line) {
    const auto begin = line.find('$');
    if (begin == line.npos) return {};
    line.remove_prefix(begin + 1);
    const auto star = line.find('*');
    if (star != line.npos) {
        unsigned sum = 0, said = 0;
        for (const char c : line.substr(0, star)) sum ^= static_cast<unsigned char>(c);
        const auto digits = line.substr(star + 1, 2);
        const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), said, 16);
        if (parsed.ec != std::errc{} || said != sum) return {};
        line = line.substr(0, star);
    }
    return cellsIn(line);
}

/** "ddmm.mmm" in degrees. */
std::optional<double> degreesIn(const std::string& text, const std::string& side) {
    const auto number = numberIn<double>(text);
    if (!number || !(*number >= 0 && *number < 18000.1) || side.size() != 1) return {};
    const double degrees = std::floor(*number / 100);
    const double value = degrees + (*number - 100 * degrees) / 60;
    if (side == "N" || side == "E") return value;
    if (side == "S" || side == "W") return -value;
    return {};
}

/** "hhmmss.sss" as seconds since midnight. */
std::optional<double> timeOfDay_s(const std::string& text) {
    const auto number = numberIn<double>(text);
    if (!number || !(*number >= 0 && *number < 240000)) return {};
    const double hours = std::floor(*number / 1e4),
                 minutes = std::floor(*number / 100) - 100 * hours;
    return 3600 * hours + 60 * minutes + (*number - 1e4 * hours - 100 * minutes);
}

/** Unix time of a day's begin (Hinnant's days from civil). */
std::optional<double> dayOf(int year, int month, int day) {
    if (year < 1980 || year > 2100 || month < 1 || month > 12 || day < 1 || day > 31) return {};
    const int y = year - (month <= 2), era = y / 400, ofEra = y - era * 400;
    const int ofYear = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return kDay_s * (era * 146097 + ofEra * 365 + ofEra / 4 - ofEra / 100 + ofYear - 719468);
}

/** The day that RMC or ZDA names. */
std::optional<double> dayIn(const std::vector<std::string>& words, const std::string& kind) {
    if (kind == "ZDA" && words.size() > 4) {
        const auto day = numberIn<int>(words[2]), month = numberIn<int>(words[3]),
                   year = numberIn<int>(words[4]);
        return day && month && year ? dayOf(*year, *month, *day) : std::nullopt;
    }
    if (kind != "RMC" || words.size() <= 9) return {};
    const auto date = numberIn<int>(words[9]);  // ddmmyy
    if (!date || *date < 0) return {};
    return dayOf(2000 + *date % 100, *date / 100 % 100, *date / 10000);
}

std::optional<earth::Fix> fixOfGga(const std::vector<std::string>& words) {
    if (words.size() < 12) return {};
    const auto time = timeOfDay_s(words[1]);
    const auto lat = degreesIn(words[2], words[3]), lon = degreesIn(words[4], words[5]);
    const auto quality = numberIn<int>(words[6]);
    const auto altitude = numberIn<double>(words[9]);
    if (!time || !lat || !lon || !quality || *quality <= 0 || *quality > 5 || !altitude) return {};
    earth::Fix fix;
    fix.stamp_s = *time;
    // Above the geoid; its own height is the next number but one.
    fix.place = {*lat, *lon, *altitude + numberIn<double>(words[11]).value_or(0)};
    fix.covariance = earth::covarianceOf(*quality, numberIn<double>(words[8]).value_or(0));
    return fix;
}

earth::Fixes fixesOfNmea(const fs::path& file, std::string_view rest) {
    earth::Fixes fixes;
    std::optional<double> day;
    while (const auto line = nextLine(rest)) {
        const auto words = sentenceIn(*line);
        if (words.empty() || words[0].size() != 5) continue;
        const std::string kind = words[0].substr(2);
        if (const auto named = dayIn(words, kind)) day = named;
        if (kind != "GGA") continue;
        auto fix = fixOfGga(words);
        if (!fix) continue;
        // The date comes in another sentence: of the next day it may come a little late.
        if (!fixes.empty() && !day) {
            while (fix->stamp_s < fixes.back().stamp_s - kDay_s / 2) fix->stamp_s += kDay_s;
        }
        if (day) {
            fix->stamp_s += *day;
            if (!fixes.empty() && fix->stamp_s < fixes.back().stamp_s - kDay_s / 2)
                fix->stamp_s += kDay_s;
        }
        fixes.push_back(*fix);
    }
    if (fixes.empty()) throw Error("'" + file.string() + "' contains no NMEA fixes (GGA)");
    // The first ones may have come before the first date.
    for (auto& fix : fixes)
        if (day && fix.stamp_s < kFirstUnix_s)
            fix.stamp_s += kDay_s * std::floor(fixes.back().stamp_s / kDay_s);
    return fixes;
}
}  // namespace

earth::Fixes readFixes(const fs::path& file) {
    const auto bytes = bytesOfFile(file);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return lowerCase(file.extension().string()) == ".csv" ? fixesOfCsv(file, text)
                                                          : fixesOfNmea(file, text);
}

void countFrom(double epoch_s, earth::Fixes& fixes) {
    for (auto& fix : fixes)
        if (fix.stamp_s > kFirstUnix_s) fix.stamp_s -= epoch_s;
}

bool isFixesFile(const fs::path& file) {
    const std::string name = lowerCase(file.filename().string());
    return name == "gnss.csv" || name == "gnss.nmea" || name == "gnss.txt";
}

std::optional<fs::path> fixesBeside(const fs::path& folder) {
    for (const auto& place : {folder, fs::absolute(folder / "").parent_path().parent_path()})
        for (const char* name : {"gnss.csv", "gnss.nmea", "gnss.txt"})
            if (fs::is_regular_file(place / name)) return place / name;
    return {};
}
}  // namespace delio::io
