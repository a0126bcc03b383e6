#include <mrpt/config/CConfigFileMemory.h>

#include <sstream>

#include "../core/checkpoint.h"
#include "delio/odometry/make_odometry.h"

namespace delio {
namespace {
const checkpoint::Label kFeatureOptions{"options of features", ""}, kFeatures{"features", ""};

template <class MethodsOptions>
std::string textOf(MethodsOptions options) {
    std::ostringstream text;
    for (const auto& [section, stage] : stagesOf(options)) stage->write(text, section);
    return text.str();
}

PaperOdometryOptions paperOptionsIn(const std::string& text) {
    const mrpt::config::CConfigFileMemory config(text);
    PaperOdometryOptions options;
    for (const auto& [section, stage] : stagesOf(options))
        stage->loadFromConfigFile(config, section);
    return options;
}
}  // namespace

void PlaneOdometry::save(std::ostream& out) const {
    checkpoint::save(out, {"odometry by planes", textOf(given_)}, *this);
}

void PlaneOdometry::restore(std::istream& in) {
    checkpoint::restore(in, {"odometry by planes", textOf(given_)}, *this);
}

void PaperOdometry::save(std::ostream& out) const {
    checkpoint::save(out, {"odometry of the paper", textOf(*options_)}, *this);
}

void PaperOdometry::restore(std::istream& in) {
    checkpoint::restore(in, {"odometry of the paper", textOf(*options_)}, *this);
}

void PaperFeatures::save(std::ostream& out) const {
    checkpoint::writePart(out, kFeatureOptions, textOf(*options));
    checkpoint::save(out, kFeatures, *this);
}

std::shared_ptr<const ScanFeatures> readFeatures(std::istream& in) {
    const auto features = std::make_shared<PaperFeatures>();
    features->options = std::make_shared<const PaperOdometryOptions>(
        paperOptionsIn(checkpoint::readPart(in, kFeatureOptions)));
    checkpoint::restore(in, kFeatures, *features);
    return features;
}
}  // namespace delio
