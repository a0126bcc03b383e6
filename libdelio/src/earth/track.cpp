#include "earth/track.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "core/percentile.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"

namespace delio::earth {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kLongestGap_s = 1;    // between two scans that a fix lies between
constexpr std::size_t kFewest = 5;     // fixes
constexpr double kDiagonal = 3;        // of the track's extent, in standard deviations of a fix
constexpr double kMaxHeading_deg = 3;  // standard deviation
constexpr double kLevel_rad = 10 * M_PI / 180;
constexpr double kOutlier = 4;        // standard deviations, of three axes together
constexpr double kMedianOf3 = 1.538;  // of the norm of three standard normal numbers
constexpr int kHypotheses = 500;
constexpr std::size_t kSample = 500;

/** A fix in the local frame, with the root of its information. */
struct Place {
    Vector3d enu, inMap;
    Matrix3d root;   //!< R' R is the inverse of the covariance
    double sigma_m;  //!< horizontal
};

double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : percentileOf(values, 50);
}

/** Componentwise median of the places, so that wrong fixes do not move it. */
Geodetic middleOf(const std::vector<FixOnTrack>& fixes) {
    std::vector<double> x, y, z;
    for (const auto& each : fixes) {
        const Vector3d ecef = ecefOf(each.fix.place);
        x.push_back(ecef.x());
        y.push_back(ecef.y());
        z.push_back(ecef.z());
    }
    return geodeticOf(Vector3d(medianOf(x), medianOf(y), medianOf(z)));
}

std::vector<Place> placesOf(const std::vector<FixOnTrack>& fixes,
                            const std::vector<Isometry3d>& poses, const EnuFrame& enu) {
    std::vector<Place> places;
    for (const auto& each : fixes) {
        Place place;
        place.enu = enu.enuOf(each.fix.place);
        place.inMap = poses[each.node] * each.antenna;
        const Matrix3d information = each.fix.covariance.inverse();
        place.root = information.llt().matrixU();
        place.sigma_m = std::sqrt((each.fix.covariance(0, 0) + each.fix.covariance(1, 1)) / 2);
        places.push_back(place);
    }
    return places;
}

/** The rotation that turns `up` to z the shortest way. */
Matrix3d levelling(const Vector3d& up) {
    return Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).toRotationMatrix();
}

/** Least median of squares over hypotheses of two fixes each, in the horizontal plane. */
Isometry3d firstGuess(const std::vector<Place>& places, const Vector3d& up) {
    const Matrix3d level = levelling(up);
    Eigen::AlignedBox3d box;
    for (const auto& place : places) box.extend(place.inMap);
    std::mt19937 random(1);
    const std::size_t step = places.size() / kSample + 1;
    Isometry3d best = Isometry3d::Identity();
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kHypotheses; ++i) {
        const Place &a = places[random() % places.size()], &b = places[random() % places.size()];
        if ((b.inMap - a.inMap).norm() < box.diagonal().norm() / 4) continue;
        const Vector3d inMap = level * (b.inMap - a.inMap), enu = b.enu - a.enu;
        const double yaw = std::atan2(enu.y(), enu.x()) - std::atan2(inMap.y(), inMap.x());
        const Matrix3d R = rotationExp(Vector3d(0, 0, yaw)) * level;
        const Vector3d t = (a.enu + b.enu - R * (a.inMap + b.inMap)) / 2;
        std::vector<double> squares;
        for (std::size_t k = 0; k < places.size(); k += step)
            squares.push_back((R * places[k].inMap + t - places[k].enu).head<2>().squaredNorm());
        const double median = medianOf(squares);
        if (median >= least) continue;
        least = median;
        best = isometry(R, t);
    }
    return best;
}

Vector3d errorOf(const Isometry3d& enuFromMap, const Place& place) {
    return place.root * (enuFromMap * place.inMap - place.enu);
}

/** Noise of the fixes over the one they claim, by the median; at least 1. */
double scaleOf(const Isometry3d& enuFromMap, const std::vector<Place>& places) {
    std::vector<double> errors;
    for (const auto& place : places) errors.push_back(errorOf(enuFromMap, place).norm());
    return std::max(1.0, medianOf(errors) / kMedianOf3);
}

/** Information and gradient of all fixes and of the level. */
struct Normals {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
};

Normals normalsAt(const Isometry3d& T, const std::vector<Place>& places, const Vector3d& up,
                  double scale, double width) {
    Normals normals;
    for (const auto& place : places) {
        const Vector3d e = errorOf(T, place) / scale;
        const double w = 1 / (1 + e.squaredNorm() / (width * width));
        Eigen::Matrix<double, 3, 6> J;
        J.leftCols<3>() = T.linear();
        J.rightCols<3>() = -T.linear() * hat(place.inMap);
        const Eigen::Matrix<double, 3, 6> rooted = place.root / scale * J;
        normals.H += w * w * rooted.transpose() * rooted;
        normals.g += w * w * rooted.transpose() * e;
    }
    // R up = z: two equations for the directions across.
    Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
    J.rightCols<3>() = -T.linear() * hat(up) / kLevel_rad;
    const Vector3d e = (T.linear() * up - Vector3d::UnitZ()) / kLevel_rad;
    normals.H += J.transpose() * J;
    normals.g += J.transpose() * e;
    return normals;
}

Isometry3d moved(const Isometry3d& T, const Vector6& step) {
    return T * isometry(rotationExp(Vector3d(step.tail<3>())), Vector3d(step.head<3>()));
}

Isometry3d refined(Isometry3d T, const std::vector<Place>& places, const Vector3d& up,
                   double& scale) {
    constexpr int kRounds = 40;
    constexpr double kWidth = 3;
    for (int round = 0; round < kRounds; ++round) {
        if (round < kRounds / 2) scale = scaleOf(T, places);
        // A wide kernel first: the first guess knows neither roll nor pitch.
        const double width = std::max(kWidth, 30 * std::pow(0.7, round));
        const auto normals = normalsAt(T, places, up, scale, width);
        const Vector6 step = -normals.H.ldlt().solve(normals.g);
        if (!step.allFinite()) break;
        T = moved(T, step);
    }
    T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
    return T;
}

/** How many successive inliers have one error: drift and slow errors of the satellites' signals do
 *  not average out. */
double correlationLength(const Isometry3d& T, const std::vector<Place>& places,
                         const std::vector<bool>& inlier) {
    std::vector<Vector3d> errors;
    for (std::size_t i = 0; i < places.size(); ++i)
        if (inlier[i]) errors.push_back(errorOf(T, places[i]));
    double power = 0, length = 1;
    for (const auto& e : errors) power += e.squaredNorm();
    for (std::size_t lag = 1; lag < errors.size() / 2 && power > 0; ++lag) {
        double sum = 0;
        for (std::size_t i = lag; i < errors.size(); ++i) sum += errors[i].dot(errors[i - lag]);
        if (sum <= 0.05 * power) break;
        length += 2 * sum / power;
    }
    return length;
}

Vector3d meanUp(const std::vector<FixOnTrack>& fixes, const std::vector<Isometry3d>& poses) {
    Vector3d up = Vector3d::Zero();
    for (const auto& each : fixes) up += poses[each.node].linear().col(2);
    return up.norm() > 1e-3 ? Vector3d(up.normalized()) : Vector3d::UnitZ();
}

/** Why the fixes cannot say where the map is; empty: they can. */
std::string whyNot(const std::vector<Place>& places) {
    if (places.size() < kFewest)
        return "only " + std::to_string(places.size()) +
               " GNSS fixes lie within the drive; at least " + std::to_string(kFewest) +
               " are needed";
    Eigen::AlignedBox2d inMap;
    std::vector<double> sigmas, east, north;
    for (const auto& place : places) {
        inMap.extend(Eigen::Vector2d(place.inMap.head<2>()));
        sigmas.push_back(place.sigma_m);
        east.push_back(place.enu.x());
        north.push_back(place.enu.y());
    }
    const double sigma = medianOf(sigmas), diagonal = inMap.diagonal().norm();
    if (diagonal <= kDiagonal * sigma)
        return "the track is too short for the heading: it spans " + rounded(diagonal, 3) +
               " m, the fixes are good to " + rounded(sigma, 2) + " m";
    // Half of them at one place, while the vehicle moved.
    const auto spread = [](std::vector<double> values) {
        std::sort(values.begin(), values.end());
        return percentileOf(values, 95) - percentileOf(values, 5);
    };
    if (std::hypot(spread(east), spread(north)) < 0.05 * diagonal)
        return "the GNSS fixes stay at one place while the vehicle moves " + rounded(diagonal, 3) +
               " m";
    return "";
}

void finish(TrackFit& fit, const std::vector<Place>& places, const Isometry3d& T,
            const Vector3d& up, const EnuFrame& enu) {
    double horizontal = 0, vertical = 0, count = 0;
    std::vector<Place> inliers;
    for (const auto& place : places) {
        const bool in = errorOf(T, place).norm() <= kOutlier * fit.scale;
        fit.inlier.push_back(in);
        if (!in) continue;
        inliers.push_back(place);
        const Vector3d error = T * place.inMap - place.enu;
        horizontal += error.head<2>().squaredNorm();
        vertical += error.z() * error.z();
        count += 1;
    }
    fit.rms_m = std::sqrt(horizontal / std::max(count, 1.0));
    fit.rmsUp_m = std::sqrt(vertical / std::max(count, 1.0));
    const double length = correlationLength(T, places, fit.inlier);
    const auto normals =
        normalsAt(T, inliers, up, fit.scale, std::numeric_limits<double>::infinity());
    fit.place.covariance = length * normals.H.ldlt().solve(Matrix6::Identity());
    fit.place.origin = enu.origin();
    fit.place.enuFromMap = T;
    fit.place.moveOriginToMap();
    fit.heading_deg = earth::heading_deg(fit.place.enuFromMap);
    const Matrix3d turn =
        T.linear() * fit.place.covariance.bottomRightCorner<3, 3>() * T.linear().transpose();
    fit.headingSigma_deg = std::sqrt(turn(2, 2)) * 180 / M_PI;
}
}  // namespace

std::vector<FixOnTrack> fixesOn(const Track& track, Fixes fixes) {
    std::stable_sort(fixes.begin(), fixes.end(),
                     [](const Fix& a, const Fix& b) { return a.stamp_s < b.stamp_s; });
    std::vector<FixOnTrack> found;
    const auto& stamps = track.stamps_s;
    for (const auto& fix : fixes) {
        if (!isUsable(fix)) continue;
        const auto after = std::upper_bound(stamps.begin(), stamps.end(), fix.stamp_s);
        if (after == stamps.begin() || after == stamps.end()) continue;
        const auto later = static_cast<std::size_t>(after - stamps.begin()), earlier = later - 1;
        const double gap_s = stamps[later] - stamps[earlier];
        if (!(gap_s > 0) || gap_s > kLongestGap_s || !track.usable[earlier] || !track.usable[later])
            continue;
        const double part = (fix.stamp_s - stamps[earlier]) / gap_s;
        const Isometry3d step = track.poses[earlier].inverse() * track.poses[later];
        const Isometry3d then = isometry(rotationExp(Vector3d(part * rotationLog(step.linear()))),
                                         Vector3d(part * step.translation()));
        const Vector3d antenna = then * fix.antenna.value_or(Vector3d::Zero());
        found.push_back({fix, part < 0.5 ? earlier : later,
                         part < 0.5 ? antenna : Vector3d(step.inverse() * antenna)});
    }
    return found;
}

TrackFit fitTrack(const std::vector<FixOnTrack>& fixes, const std::vector<Isometry3d>& poses) {
    TrackFit fit;
    const EnuFrame enu(fixes.empty() ? Geodetic{} : middleOf(fixes));
    const auto places = placesOf(fixes, poses, enu);
    fit.refusal = whyNot(places);
    if (!fit.refusal.empty()) return fit;
    const Vector3d up = meanUp(fixes, poses);
    const Isometry3d T = refined(firstGuess(places, up), places, up, fit.scale);
    finish(fit, places, T, up, enu);
    const auto inliers =
        static_cast<std::size_t>(std::count(fit.inlier.begin(), fit.inlier.end(), true));
    if (2 * inliers < places.size())
        fit.refusal = "only " + std::to_string(inliers) + " of " + std::to_string(places.size()) +
                      " GNSS fixes agree with the track";
    else if (!(fit.headingSigma_deg < kMaxHeading_deg))
        fit.refusal = "the track is too short or straight for the heading: known to " +
                      rounded(fit.headingSigma_deg, 2) + " deg, " + rounded(kMaxHeading_deg, 1) +
                      " are needed";
    return fit;
}
}  // namespace delio::earth
