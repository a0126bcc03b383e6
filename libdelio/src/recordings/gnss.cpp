#include "gnss.h"

#include <cmath>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "mrpt/clock.h"

namespace delio::io {
std::optional<earth::Fix> fixOf(const mrpt::obs::CObservationGPS& observation, double epoch_s) {
    using Gga = mrpt::obs::gnss::Message_NMEA_GGA;
    if (!observation.hasMsgClass<Gga>()) return {};
    const auto& fields = observation.getMsgByClass<Gga>().fields;
    if (fields.fix_quality == 0 || fields.fix_quality > 5) return {};
    earth::Fix fix;
    fix.stamp_s = secondsSince(epoch_s, observation.timestamp);
    fix.place = {fields.latitude_degrees, fields.longitude_degrees,
                 fields.altitude_meters + fields.geoidal_distance};
    fix.covariance =
        earth::covarianceOf(fields.fix_quality, fields.thereis_HDOP ? double{fields.HDOP} : 0);
    fix.antenna = fromMrpt(observation.sensorPose).translation();
    return fix;
}

std::optional<earth::Fix> fixOf(const Message& message) {
    WireReader reader(message);
    earth::Fix fix;
    fix.stamp_s = reader.header().stamp_s;
    const auto status = static_cast<std::int8_t>(reader.number<std::uint8_t>());
    reader.number<std::uint16_t>();  // the satellites' service
    fix.place.latitude_deg = reader.real();
    fix.place.longitude_deg = reader.real();
    fix.place.height_m = reader.real();
    Eigen::Matrix3d covariance;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) covariance(row, column) = reader.real();
    const auto kind = reader.number<std::uint8_t>();
    if (status < 0) return {};
    // STATUS_SBAS_FIX and STATUS_GBAS_FIX are differential.
    fix.covariance = earth::covarianceOf(status == 0 ? 1 : 2, 0);
    if (kind != 0 && (covariance.diagonal().array() > 0).all()) fix.covariance = covariance;
    if (!std::isfinite(fix.place.height_m)) {
        constexpr double kUnknown_m = 1e3;
        fix.place.height_m = 0;
        fix.covariance.row(2).setZero();
        fix.covariance.col(2).setZero();
        fix.covariance(2, 2) = kUnknown_m * kUnknown_m;
    }
    return fix;
}

bool isFixType(const std::string& type) {
    return type == "sensor_msgs/NavSatFix" || type == "sensor_msgs/msg/NavSatFix";
}

earth::Fixes fixesOfBag(
    const OpenSource& open,
    const std::function<std::optional<Eigen::Isometry3d>(const std::string&)>& poseOf) {
    earth::Fixes fixes;
    try {
        const auto bag = open();
        std::optional<std::string> topic;
        for (const auto& each : bag->topics())
            if (isFixType(each.type) && (!topic || each.name < *topic)) topic = each.name;
        if (!topic) return fixes;
        bag->only({*topic});
        while (const auto message = bag->next()) {
            auto fix = fixOf(*message);
            if (!fix) continue;
            const auto antenna = poseOf(WireReader(*message).header().frame);
            if (antenna) fix->antenna = antenna->translation();
            fixes.push_back(*fix);
        }
    } catch (const std::exception&) {
        // The reader of the scans says what is damaged.
    }
    return fixes;
}
}  // namespace delio::io
