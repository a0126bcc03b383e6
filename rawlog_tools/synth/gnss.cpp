#include "gnss.h"

#include <algorithm>
#include <cmath>

#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "random.h"

namespace delio::synth {
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {
constexpr std::uint64_t kKey = 0x6A1155;  // of the random numbers
constexpr double kTurn_rad = 35 * M_PI / 180;
constexpr double kEpisode_s = 3;  // errors by reflected signals last so long

std::string row(std::initializer_list<double> values, int decimals) {
    std::string text;
    for (const double value : values) text += ',' + fixed(value, decimals);
    return text;
}
}  // namespace

earth::Geodetic originOfWorlds() { return {49.0, 8.4, 115}; }

GnssReceiver::GnssReceiver(const GnssRequest& request,
                           std::function<Isometry3d(double time_s)> lidarAt,
                           const Isometry3d& vehicleFromUpright)
    : request_(request),
      lidarAt_(std::move(lidarAt)),
      enuFromWorld_(isometry(rotationExp({0, 0, kTurn_rad}), Vector3d::Zero())),
      antennaOfVehicle_(vehicleFromUpright * request.antenna),
      enu_(originOfWorlds()) {
    const Isometry3d enuFromMap = enuFromWorld_ * lidarAt_(0) * vehicleFromUpright.inverse();
    truth_ = "# east, north, up at latitude, longitude, height " +
             rounded(enu_.origin().latitude_deg, 17) + " " +
             rounded(enu_.origin().longitude_deg, 17) + " " + rounded(enu_.origin().height_m, 17) +
             "\n# enu_from_map";
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) truth_ += " " + rounded(enuFromMap.matrix()(r, c), 17);
    truth_ += "\nstamp_s,latitude,longitude,height,error_east,error_north,error_up,jump\n";
}

int GnssReceiver::quality() const {
    return request_.sigma_m <= 0.1 ? 4 : request_.sigma_m <= 0.6 ? 5 : request_.sigma_m < 2 ? 2 : 1;
}

earth::Fix GnssReceiver::fixAt(std::size_t number) {
    // A little after the scans: the poses have to be interpolated.
    earth::Fix fix;
    fix.stamp_s = 0.013 + static_cast<double>(number) / request_.rate_hz;
    fix.antenna = antennaOfVehicle_;
    Random random{request_.seed, kKey, number};
    const double sigma = request_.sigma_m;
    Vector3d error(sigma * random.normal(), sigma * random.normal(), 2 * sigma * random.normal());
    const auto episode = static_cast<std::uint64_t>(fix.stamp_s / kEpisode_s);
    Random ofEpisode{request_.seed, kKey + 1, episode};
    const bool jump = ofEpisode.chance(request_.jumps);
    const double azimuth = ofEpisode.uniform(0, 2 * M_PI);
    if (jump) error += kJump_m * Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
    const Vector3d truth = enuFromWorld_ * (lidarAt_(fix.stamp_s) * request_.antenna);
    fix.place = enu_.geodeticOf(truth + error);
    const double least = std::max(sigma, 0.01);
    fix.covariance = Vector3d(least * least, least * least, 4 * least * least).asDiagonal();
    const auto place = enu_.geodeticOf(truth);
    truth_ += fixed(fix.stamp_s, 3) + row({place.latitude_deg, place.longitude_deg}, 10) +
              row({place.height_m, error.x(), error.y(), error.z()}, 4) + (jump ? ",1\n" : ",0\n");
    return fix;
}

void GnssReceiver::upTo(double time_s, const std::function<void(const earth::Fix& fix)>& take) {
    while (0.013 + static_cast<double>(count_) / request_.rate_hz <= time_s) {
        const auto fix = fixAt(count_++);
        if (fix.stamp_s >= request_.gapFirst_s && fix.stamp_s < request_.gapLast_s) continue;
        take(fix);
    }
}
}  // namespace delio::synth
