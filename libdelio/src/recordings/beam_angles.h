#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace delio::io {
/** Where a laser of a spinning LiDAR points to, degrees: its elevation, and how far it is ahead of
 *  the azimuth of its block. */
struct BeamAngles {
    double elevation_deg = 0, azimuth_deg = 0;
};

/** A laser's direction at azimuth 0. */
struct BeamDirection {
    explicit BeamDirection(const BeamAngles& angles);
    double sineUp, cosineUp, sine, cosine;
};
std::vector<BeamDirection> directionsOf(const std::vector<BeamAngles>& angles);

/** Angles of `lasers` lasers from a text file: a line each of channel (from 1), elevation and
 *  azimuth, or of the latter two; a first line without numbers is passed over. Throws Error, which
 *  names the file, for anything else. */
std::vector<BeamAngles> readBeamAngles(const std::string& file, std::size_t lasers);
}  // namespace delio::io
