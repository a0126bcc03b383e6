#include "odometry/inertial.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "delio/core/geometry.h"
#include "delio/core/text.h"

namespace delio::odometry {
namespace {
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDeg = M_PI / 180;
constexpr double kMostOffset_s = 0.1;   //!< between the clocks of LiDAR and IMU
constexpr double kLongest_s = 0.1;      //!< rotations by which a bias adds linearly
constexpr double kBeyondLast_s = 0.02;  //!< a rate is taken to last so long
constexpr double kRobust_rad = 1 * kDeg;
constexpr std::size_t kFewestPairs = 15;  //!< of a calibration

Quaterniond quaternionOf(const Vector3d& w) { return Quaterniond(rotationExp(w)); }

/** Weight of a residual (Cauchy). */
double weightOf(double squared) { return 1 / (1 + squared / (kRobust_rad * kRobust_rad)); }

std::string degrees(double rad, int digits) { return rounded(rad / kDeg, digits); }
}  // namespace

void GyroPrior::add(const ImuSample& sample) {
    constexpr double kDamaged = 1e4;  // rad/s; no gyroscope has so much in deg/s either
    const bool isUsable = std::isfinite(sample.stamp_s) && sample.rate_radps.allFinite() &&
                          sample.rate_radps.cwiseAbs().maxCoeff() < kDamaged &&
                          (!sample.sensorPose || sample.sensorPose->matrix().allFinite());
    if (!isUsable || !waiting_.add(sample)) ++dropped_;
}

void GyroPrior::advance(const ScanClock& scan, const Eigen::Isometry3d& sensorPose) {
    constexpr double kSame_s = 1e-3, kMemory_s = 60;
    if (isEmpty()) return;
    const double shift_s = scan.clock_s - scan.time_s;
    if (std::abs(shift_s - shift_s_) > kSame_s) ++stretch_;  // a clock was set, or a pause
    shift_s_ = shift_s;
    const double end_s = scan.time_s + scan.last_s + kMostOffset_s;
    waiting_.takeUpTo(end_s, shift_s, [&](const ImuSample& sample) {
        if (sample.sensorPose) imuPose_ = sample.sensorPose->linear();
        if (sample.offset_s && !offsetSigma_s_ && pairs_.empty()) offset_s_ = *sample.offset_s;
        use(sample.stamp_s - shift_s, sample.rate_radps);
    });
    if (imuPose_) given_ = normalised(Matrix3d(sensorPose.linear().transpose() * *imuPose_));
    while (!readings_.empty() && readings_.front().time_s < end_s - kMemory_s)
        readings_.pop_front();
    const double from_s = scan.time_s - kLongest_s / 2, to_s = scan.time_s + scan.last_s;
    covered_ = turnBetween(from_s, to_s, offset_s_).has_value();
    if (!mount_) takeMount();
}

void GyroPrior::use(double time_s, const Vector3d& rate) {
    constexpr double kShort_s = 0.03, kLong_s = 0.15, kUsualTimes = 4, kFrozen_s = 0.3,
                     kForget = 0.1;
    constexpr unsigned kFrozen = 10;
    ++samples_;
    if (readings_.empty()) {
        readings_.push_back({time_s, rate, Quaterniond::Identity(), stretch_});
        return;
    }
    const Reading& last = readings_.back();
    const double passed_s = time_s - last.time_s;
    if (!(passed_s > 0)) {
        ++dropped_;
        return;
    }
    same_ = rate == last.rate ? same_ + 1 : 0;
    frozen_ = same_ >= kFrozen && same_ * usual_s_ >= kFrozen_s;
    if (frozen_) frozen_s_ += std::min(passed_s, kLong_s);
    if (frozen_ || passed_s > std::max(kUsualTimes * usual_s_, kShort_s)) ++stretch_;
    usual_s_ += kForget * (std::min(passed_s, kLong_s) - usual_s_);
    const Vector3d turn = (last.rate + rate) / 2 * passed_s;
    readings_.push_back({time_s, rate, (last.turned * quaternionOf(turn)).normalized(), stretch_});
}

/** By the rates as they are, which change evenly from one reading to the next. */
std::optional<GyroPrior::Attitude> GyroPrior::attitudeAt(double imuTime_s) const {
    const auto next =
        std::upper_bound(readings_.begin(), readings_.end(), imuTime_s,
                         [](double time_s, const Reading& r) { return time_s < r.time_s; });
    if (next == readings_.begin()) return {};
    const Reading& before = *std::prev(next);
    const double since_s = imuTime_s - before.time_s;
    if (next == readings_.end()) {
        if (since_s > kBeyondLast_s) return {};
        return Attitude{before.turned * quaternionOf(before.rate * since_s), before.stretch};
    }
    if (before.stretch != next->stretch) return {};
    const Vector3d gained = (next->rate - before.rate) * since_s / (next->time_s - before.time_s);
    return Attitude{before.turned * quaternionOf((before.rate + gained / 2) * since_s),
                    before.stretch};
}

/** A rotation vector in the IMU's axes, by the rates as they are. */
std::optional<Vector3d> GyroPrior::turnBetween(double from_s, double to_s, double offset_s) const {
    const auto from = attitudeAt(from_s + offset_s), to = attitudeAt(to_s + offset_s);
    if (!from || !to || from->stretch != to->stretch) return {};
    return rotationLog((from->turned.conjugate() * to->turned).normalized().toRotationMatrix());
}

GyroPrior GyroPrior::reversed() const {
    GyroPrior back = *this;
    back.isReversed_ = !isReversed_;
    return back;
}

std::optional<Matrix3d> GyroPrior::rotation(double from_s, double to_s) const {
    if (!mount_) return {};
    if (isReversed_) {
        from_s = -from_s;
        to_s = -to_s;
    }
    const int parts =
        std::max(1, static_cast<int>(std::ceil(std::abs(to_s - from_s) / kLongest_s)));
    const double part_s = (to_s - from_s) / parts;
    Matrix3d rotation = Matrix3d::Identity();
    for (int i = 0; i < parts; ++i) {
        const auto turn = turnBetween(from_s + i * part_s, from_s + (i + 1) * part_s, offset_s_);
        if (!turn) return {};
        rotation = rotation * rotationExp(*mount_ * (*turn - part_s * bias_));
    }
    return rotation;
}

std::optional<ScanTrajectory> GyroPrior::trajectory(const Eigen::Isometry3d& pose,
                                                    const Vector3d& velocity, double time_s,
                                                    double first_s, double last_s) const {
    constexpr double kInterval_s = 0.005;
    const int parts = std::max(1, static_cast<int>(std::ceil((last_s - first_s) / kInterval_s)));
    std::vector<double> times_s;
    std::vector<Eigen::Isometry3d> poses;
    for (int i = 0; i <= parts; ++i) {
        const double at_s = first_s + i * (last_s - first_s) / parts;
        const auto turned = rotation(time_s, time_s + at_s);
        if (!turned) return {};
        times_s.push_back(at_s);
        poses.push_back(isometry(pose.linear() * *turned, pose.translation() + at_s * velocity));
    }
    if (!(times_s.back() > times_s.front())) return {};
    return ScanTrajectory(times_s, poses);
}

void GyroPrior::observe(double from_s, double to_s, const Matrix3d& rotation) {
    if (isReversed_) return;
    constexpr std::size_t kMost = 300, kFirst = 10, kLater = 50;
    constexpr double kLongestPair_s = 0.35;
    if (!(to_s > from_s) || to_s - from_s > kLongestPair_s) return;
    const auto turn = turnBetween(from_s, to_s, offset_s_);
    if (!turn) return;
    pairs_.push_back({from_s, to_s, rotationLog(rotation), *turn});
    if (pairs_.size() > kMost) pairs_.pop_front();
    lidarTurned_rad_ += pairs_.back().lidar.norm();
    for (auto r = readings_.rbegin(); r != readings_.rend() && r->time_s > from_s + offset_s_; ++r)
        if (r->time_s <= to_s + offset_s_) imuTurned_rad_ += usual_s_ * r->rate.norm();
    // The longer the drive, the less a few more scans add.
    const bool isNew = !calibrated_ || pairs_.size() < 100;
    if (++sinceCalibration_ >= (isNew ? kFirst : kLater)) calibrate();
    estimateBias();
    judge();
}

/** The pairs whose samples are there at an offset. */
std::vector<GyroPrior::Pair> GyroPrior::pairsAt(double offset_s) const {
    std::vector<Pair> pairs;
    for (Pair pair : pairs_)
        if (const auto turn = turnBetween(pair.from_s, pair.to_s, offset_s)) {
            pair.imu = *turn;
            pairs.push_back(pair);
        }
    return pairs;
}

/** Rotation and bias that bring the IMU's rotation vectors onto the LiDAR's: lidar = R imu - T b.
 *  Without their parts along the durations T, both are related by R alone (Kabsch). */
GyroPrior::Fit GyroPrior::aligned(const std::vector<Pair>& pairs,
                                  const std::vector<double>& weights) {
    Vector3d lidar = Vector3d::Zero(), imu = lidar;
    double durations = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double weight = weights[i] * pairs[i].duration_s();
        lidar += weight * pairs[i].lidar;
        imu += weight * pairs[i].imu;
        durations += weight * pairs[i].duration_s();
    }
    lidar /= durations;
    imu /= durations;
    Matrix3d both = Matrix3d::Zero(), ofLidar = both;
    double imuSquares = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Vector3d l = pairs[i].lidar - pairs[i].duration_s() * lidar,
                       m = pairs[i].imu - pairs[i].duration_s() * imu;
        both += weights[i] * l * m.transpose();
        ofLidar += weights[i] * l * l.transpose();
        imuSquares += weights[i] * m.squaredNorm();
    }
    constexpr double kClear = 0.1, kLeast = 1e-12;
    const Eigen::JacobiSVD<Matrix3d> svd(both, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    Fit fit;
    fit.rotation = svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    fit.bias = fit.rotation * imu - lidar;
    fit.mirrored = sign < 0 && svd.singularValues()[2] > kClear * svd.singularValues()[0];
    fit.ratio = (fit.rotation.transpose() * both).trace() / std::max(imuSquares, kLeast);
    fit.squares = std::max(ofLidar.trace(), kLeast);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> spread(ofLidar);
    fit.information =
        std::max(spread.eigenvalues()[0] + spread.eigenvalues()[1], kLeast);  // about the worst
    return fit;
}

GyroPrior::Fit GyroPrior::fitAt(double offset_s) const {
    constexpr unsigned kRounds = 3;
    constexpr double kLeast_rad = 0.03 * kDeg;
    const auto pairs = pairsAt(offset_s);
    Fit fit;
    if (pairs.size() < kFewestPairs) return fit;
    std::vector<double> weights(pairs.size(), 1);
    bool mirrored = false;
    double rest = 0, cost = 0;
    for (unsigned round = 0; round < kRounds; ++round) {
        fit = aligned(pairs, weights);
        if (round == 0) mirrored = fit.mirrored;
        rest = cost = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const double r =
                (fit.rotation * pairs[i].imu - pairs[i].lidar - pairs[i].duration_s() * fit.bias)
                    .squaredNorm();
            rest += weights[i] * r;
            cost += std::log1p(r / (kRobust_rad * kRobust_rad));
            weights[i] = weightOf(r);
        }
    }
    fit.mirrored = mirrored;
    fit.pairs = pairs.size();
    fit.cost = cost / static_cast<double>(pairs.size());
    fit.explained = 1 - rest / fit.squares;
    const double noise = rest / static_cast<double>(3 * pairs.size() - 6);
    fit.sigma_rad = std::sqrt(std::max(noise, kLeast_rad * kLeast_rad) / fit.information);
    return fit;
}

double GyroPrior::costAt(double offset_s) const {
    const Fit fit = fitAt(offset_s);
    return fit.pairs < kFewestPairs ? INFINITY : fit.cost;
}

/** The offset of the least cost: on a grid, then by intervals of golden ratio. */
double GyroPrior::bestOffset() const {
    constexpr double kStep_s = 0.01, kGolden = 0.6180339887498949;
    constexpr unsigned kRounds = 10;
    double best_s = offset_s_;
    if (!offsetSigma_s_) {
        double least = INFINITY;
        for (double offset_s = -kMostOffset_s; offset_s < kMostOffset_s + kStep_s / 2;
             offset_s += kStep_s) {
            const Fit fit = fitAt(offset_s);
            if (fit.pairs < kFewestPairs || fit.cost >= least) continue;
            least = fit.cost;
            best_s = offset_s;
        }
    }
    double low = best_s - kStep_s, high = best_s + kStep_s;
    double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    double leftCost = costAt(left), rightCost = costAt(right);
    for (unsigned i = 0; i < kRounds; ++i) {
        if (leftCost < rightCost) {
            high = right;
            right = left;
            rightCost = leftCost;
            left = high - kGolden * (high - low);
            leftCost = costAt(left);
        } else {
            low = left;
            left = right;
            leftCost = rightCost;
            right = low + kGolden * (high - low);
            rightCost = costAt(right);
        }
    }
    return (low + high) / 2;
}

/** The registered rotations turn about more than one axis, so that they show how the IMU is
 *  mounted. */
bool GyroPrior::showsEnoughMotion() const {
    constexpr double kNoise_rad = 0.1 * kDeg, kCoarse_rad = 3 * kDeg;
    Matrix3d squares = Matrix3d::Zero();
    for (const Pair& pair : pairs_) squares += pair.lidar * pair.lidar.transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> spread(squares);
    return spread.eigenvalues()[0] + spread.eigenvalues()[1] >
           std::pow(kNoise_rad / kCoarse_rad, 2);
}

void GyroPrior::calibrate() {
    constexpr double kExplained = 0.8, kPrecise_rad = 1 * kDeg, kLowest = 0.85, kHighest = 1.15;
    sinceCalibration_ = 0;
    if (pairs_.size() < kFewestPairs || !showsEnoughMotion()) return;
    const double offset_s = bestOffset();
    const Fit fit = fitAt(offset_s);
    mirrored_ = fitAt(offset_s_).mirrored;
    if (fit.pairs < kFewestPairs || fit.explained < kExplained || fit.sigma_rad > kPrecise_rad ||
        fit.ratio < kLowest || fit.ratio > kHighest || fit.mirrored)
        return;
    calibrated_ = fit;
    // The curvature of the cost says how well the offset is known.
    constexpr double kProbe_s = 2e-3, kKnown_s = 3e-3;
    const double bend = (costAt(offset_s - kProbe_s) + costAt(offset_s + kProbe_s) - 2 * fit.cost) /
                        (kProbe_s * kProbe_s) * static_cast<double>(fit.pairs);
    const double noise = std::max(fit.cost, 1e-4);
    const double sigma_s =
        bend > 0 && std::isfinite(bend) ? std::sqrt(2 * noise / (3 * bend)) : INFINITY;
    if (sigma_s < kKnown_s && std::abs(offset_s) < kMostOffset_s) {
        offsetSigma_s_ = sigma_s;
        adopt(offset_s);
    }
    takeMount();
}

void GyroPrior::adopt(double offset_s) {
    offset_s_ = offset_s;
    const auto pairs = pairsAt(offset_s);
    pairs_.assign(pairs.begin(), pairs.end());
}

/** The calibrated rotation where the source gives none, or it is precise, or contradicts that. */
void GyroPrior::takeMount() {
    constexpr double kPrecise_rad = 0.2 * kDeg, kOff_rad = 3 * kDeg, kSigmas = 5;
    mount_ = given_;
    if (!calibrated_) return;
    const double sigma_rad = calibrated_->sigma_rad;
    const bool contradicts = given_ && angleOf(given_->transpose() * calibrated_->rotation) >
                                           std::max(kOff_rad, kSigmas * sigma_rad);
    if (!given_ || contradicts || sigma_rad < kPrecise_rad) mount_ = calibrated_->rotation;
}

/** Robust mean of the differences in rate. A scan's error counts in two rotations, once with each
 *  sign, so that it nearly cancels. */
void GyroPrior::estimateBias() {
    constexpr std::size_t kLatest = 50, kFewest = 3;
    constexpr unsigned kRounds = 3;
    if (!mount_ || pairs_.size() < kFewest) return;
    const std::size_t first = pairs_.size() > kLatest ? pairs_.size() - kLatest : 0;
    for (unsigned round = 0; round < kRounds; ++round) {
        Vector3d sum = Vector3d::Zero();
        double squares = 0;
        for (std::size_t i = first; i < pairs_.size(); ++i) {
            const Pair& pair = pairs_[i];
            const Vector3d off = pair.imu - mount_->transpose() * pair.lidar;
            const double weight =
                weightOf((off - pair.duration_s() * bias_).squaredNorm()) * pair.duration_s();
            sum += weight * off;
            squares += weight * pair.duration_s();
        }
        bias_ = sum / squares;
    }
}

Vector3d GyroPrior::residualOf(const Pair& pair) const {
    return pair.lidar - *mount_ * (pair.imu - pair.duration_s() * bias_);
}

/** Trusted after motion that the gyroscope explains, until several of the latest rotations differ.
 */
void GyroPrior::judge() {
    constexpr std::size_t kFewest = 5, kLatest = 10, kMemory = 30, kMostBad = 3, kGoodAgain = 1;
    constexpr double kBad_rad = 1 * kDeg, kBadShare = 0.25, kTurned_rad = 3 * kDeg, kRest = 0.1;
    trusted_ = trusted_ && mount_;
    turned_ = false;
    if (!mount_) return;
    double squares = 0, rest = 0;
    std::size_t bad = 0, seen = 0;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend() && seen < kMemory; ++pair, ++seen) {
        const double off = residualOf(*pair).norm(), turned = pair->lidar.norm();
        const bool isBad = off > std::max(kBad_rad, kBadShare * turned);
        bad += isBad && seen < kLatest;
        squares += turned * turned;
        rest += off * off;
    }
    if (seen > 0) residual_rad_ = std::sqrt(rest / static_cast<double>(seen));
    if (bad > kMostBad) trusted_ = false;
    turned_ = squares > kTurned_rad * kTurned_rad;
    const bool isExplained = turned_ && rest < kRest * squares && bad <= kGoodAgain;
    if (seen >= kFewest && isExplained) trusted_ = true;
    wasTrusted_ = wasTrusted_ || trusted_;
}

void GyroPrior::count(bool used) {
    if (samples_ == 0) return;
    ++scans_;
    used_ += used;
    without_ += !covered_;
    distrusted_ += !used && covered_ && wasTrusted_ && !trusted_;
}

std::optional<ImuReport> GyroPrior::report() const {
    if (samples_ + dropped_ == 0 && waiting_.isEmpty()) return {};
    ImuReport report;
    report.samples = samples_;
    report.dropped = dropped_;
    report.scans = scans_;
    report.scansUsed = used_;
    report.scansWithout = without_;
    if (wasTrusted_) report.rotation = mount_;
    if (calibrated_) report.rotationSigma_rad = calibrated_->sigma_rad;
    report.offset_s = offset_s_;
    report.offsetSigma_s = offsetSigma_s_;
    report.bias_radps = bias_;
    report.residual_rad = residual_rad_;
    explain(report);
    return report;
}

void GyroPrior::explain(ImuReport& report) const {
    constexpr double kFew = 0.02, kInDegrees = 30, kSeen_rad = 20 * kDeg;
    const auto say = [&](const std::string& text) { report.findings.push_back(text); };
    const auto of = [&](std::size_t scans) {
        return std::to_string(scans) + " of " + std::to_string(scans_) + " scans";
    };
    if (dropped_ > 0)
        say(std::to_string(dropped_) +
            " IMU samples are ignored: without angular velocity, not finite, or with a stamp that "
            "does not increase");
    const bool isNever =
        samples_ == 0 ? !waiting_.isEmpty() : without_ == scans_ && scans_ >= kFewestPairs;
    if (isNever && frozen_s_ == 0)
        return say(
            "the IMU is not used: none of its samples lies between two scans; its "
            "stamps seem to come from another clock");
    if (static_cast<double>(without_) > kFew * static_cast<double>(scans_))
        say("no IMU samples for " + of(without_) + ": their rotation is predicted without them");
    if (frozen_s_ > 0)
        say("the IMU's angular velocity was frozen for " + rounded(frozen_s_, 2) +
            " s (equal values): not used there");
    if (distrusted_ > 0)
        say("the IMU's angular velocity contradicts the scans: not used for " + of(distrusted_));
    if (wasTrusted_) {
        if (given_ && calibrated_ && mount_ && *mount_ != *given_) {
            const double off = angleOf(given_->transpose() * *mount_);
            if (off > 3 * kDeg)
                say("the IMU's orientation in the recording is off by " + degrees(off, 3) +
                    " deg: the calibrated one is used");
        }
        return;
    }
    if (samples_ == 0 || scans_ < kFewestPairs) return;
    std::string why = "the IMU is not used: ";
    if (imuTurned_rad_ > kInDegrees * lidarTurned_rad_ && imuTurned_rad_ > kSeen_rad)
        why += "its angular velocity is " +
               rounded(imuTurned_rad_ / std::max(lidarTurned_rad_, 1e-9), 2) +
               " times that of the scans; is it in deg/s? DeLiO expects rad/s";
    else if (mirrored_)
        why += "its axes are mirrored (a left-handed frame)";
    else if (lidarTurned_rad_ < kSeen_rad || (!mount_ && !showsEnoughMotion()))
        why += "the sensor turned too little to check it";
    else
        why += "its angular velocity contradicts the rotation between the scans";
    say(why);
}
}  // namespace delio::odometry
