#include "delio/loops/azimuths.h"
#include "core/portable_math.h"

#include <algorithm>
#include <cmath>

namespace delio::loops {
namespace {
constexpr Eigen::Index kBins = Azimuths::kBins;
constexpr double kWidth = M_PI / kBins;

Eigen::Index wrapped(Eigen::Index bin) { return ((bin % kBins) + kBins) % kBins; }

/** Circular, with a Gaussian of 1 deg: what a wall's normals scatter. */
Eigen::VectorXd smoothed(const Eigen::VectorXd& weights) {
    constexpr double kSigma = M_PI / 180 / kWidth;
    constexpr auto kReach = static_cast<Eigen::Index>(3 * kSigma);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(kBins);
    for (Eigen::Index offset = -kReach; offset <= kReach; ++offset) {
        const auto off = static_cast<float>(static_cast<double>(offset) / kSigma);
        const double share = double{portable::exp(-0.5F * off * off)};
        for (Eigen::Index i = 0; i < kBins; ++i) result[i] += share * weights[wrapped(i + offset)];
    }
    return result;
}
}  // namespace

Azimuths::Azimuths(const paper::SurfaceNormals& surfaces)
    : weights_(Eigen::VectorXd::Zero(kBins)) {
    constexpr float kLevel = 0.5F;  // 30 deg
    for (Eigen::Index i = 0; i < surfaces.directions.cols(); ++i) {
        const Eigen::Vector3f n = surfaces.directions.col(i);
        if (std::abs(n.z()) > kLevel) continue;
        const double azimuth = std::atan2(n.y(), n.x());
        weights_[wrapped(static_cast<Eigen::Index>(std::floor(azimuth / kWidth)))] +=
            static_cast<double>(surfaces.planarity[i]);
    }
    weights_ = smoothed(weights_);
    // What looks every way alike says nothing.
    weights_.array() -= weights_.mean();
    if (weights_.norm() > 0) weights_.normalize();
}

std::vector<double> Azimuths::turnsOf(const Azimuths& other, double expected, double reach,
                                      std::size_t most) const {
    const auto at = [&](Eigen::Index turn) {
        double sum = 0;
        for (Eigen::Index i = 0; i < kBins; ++i)
            sum += weights_[wrapped(i + turn)] * other.weights_[i];
        return sum;
    };
    const auto first = static_cast<Eigen::Index>(std::floor((expected - reach) / kWidth)),
               last = static_cast<Eigen::Index>(std::ceil((expected + reach) / kWidth));
    Eigen::VectorXd scores(last - first + 1);
    for (Eigen::Index i = 0; i < scores.size(); ++i) scores[i] = at(first + i);
    std::vector<Eigen::Index> peaks;
    for (Eigen::Index i = 1; i + 1 < scores.size(); ++i)
        if (scores[i] > 0 && scores[i] >= scores[i - 1] && scores[i] > scores[i + 1])
            peaks.push_back(i);
    std::stable_sort(peaks.begin(), peaks.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return scores[a] > scores[b]; });
    if (peaks.size() > most) peaks.resize(most);
    std::vector<double> turns;
    turns.reserve(peaks.size());
    for (const auto peak : peaks) turns.push_back(static_cast<double>(first + peak) * kWidth);
    return turns;
}
}  // namespace delio::loops
