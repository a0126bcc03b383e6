#include "beam_angles.h"

#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "core/portable_math.h"
#include "delio/core/error.h"
#include "delio/core/text.h"

namespace delio::io {
BeamDirection::BeamDirection(const BeamAngles& angles)
    : sineUp(portable::sin(mrpt::DEG2RAD(angles.elevation_deg))),
      cosineUp(portable::cos(mrpt::DEG2RAD(angles.elevation_deg))),
      sine(portable::sin(mrpt::DEG2RAD(angles.azimuth_deg))),
      cosine(portable::cos(mrpt::DEG2RAD(angles.azimuth_deg))) {}

std::vector<BeamDirection> directionsOf(const std::vector<BeamAngles>& angles) {
    return {angles.begin(), angles.end()};
}

namespace {
[[noreturn]] void refuse(const std::string& file, const std::string& why) {
    throw Error("'" + file +
                "' is not a table of beam angles (channel, elevation, azimuth in "
                "degrees): " +
                why);
}

/** The numbers of a line, which are separated by commas or blanks. */
std::vector<double> numbersOf(std::string line) {
    std::replace(line.begin(), line.end(), ',', ' ');
    return numbersIn(line);
}

/** Channels are counted from 1; `line` from 1 as well. */
BeamAngles anglesOf(const std::string& file, const std::vector<double>& row, std::size_t channel,
                    std::size_t line) {
    const bool isCounted = row.size() == 3;
    if (!isCounted && row.size() != 2)
        refuse(file,
               "line " + std::to_string(line) + " has " + std::to_string(row.size()) + " numbers");
    if (isCounted && row[0] != static_cast<double>(channel))
        refuse(file,
               "line " + std::to_string(line) + " is not of channel " + std::to_string(channel));
    const BeamAngles angles{row[row.size() - 2], row[row.size() - 1]};
    if (!(std::abs(angles.elevation_deg) <= 90 && std::abs(angles.azimuth_deg) <= 360))
        refuse(file, "line " + std::to_string(line) + " has no angles");
    return angles;
}
}  // namespace

std::vector<BeamAngles> readBeamAngles(const std::string& file, std::size_t lasers) {
    constexpr std::uintmax_t kMostBytes = 1'000'000;
    std::error_code none;
    if (!std::filesystem::is_regular_file(file, none))
        throw Error("no such file of beam angles: '" + file + "'");
    if (std::filesystem::file_size(file, none) > kMostBytes) refuse(file, "it is too large");
    std::ifstream in(file);
    std::vector<BeamAngles> angles;
    std::size_t count = 0;
    for (std::string line; std::getline(in, line);) {
        ++count;
        const auto row = numbersOf(line);
        const bool isEmpty = line.find_first_not_of(" \t\r") == std::string::npos;
        if (isEmpty || (row.empty() && count == 1)) continue;  // column names
        angles.push_back(anglesOf(file, row, angles.size() + 1, count));
        if (angles.size() > lasers) break;
    }
    if (angles.size() != lasers)
        refuse(file, "it has " + std::string(angles.size() > lasers ? "more than " : "") +
                         std::to_string(std::min(angles.size(), lasers)) +
                         " channels and the sensor has " + std::to_string(lasers));
    return angles;
}
}  // namespace delio::io
