#include "delio/profile.h"

#include <mrpt/config/CConfigFileMemory.h>

#include <algorithm>
#include <ostream>
#include <sstream>

#include "delio/error.h"
#include "profile_texts.h"

namespace delio {
using mrpt::config::CConfigFileMemory;

namespace {
/** MRPT's reader passes silently over what it does not understand. */
void requireIniLines(const std::string& text) {
    std::istringstream in(text);
    bool inSection = false;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        const auto first = line.find_first_not_of(" \t\r");
        if (first == line.npos || line[first] == '#' || line[first] == ';') continue;
        const bool isSection = line[first] == '[' && line.find(']') != line.npos;
        inSection = inSection || isSection;
        const auto equals = line.find('=');
        if (!isSection && (!inSection || equals == line.npos || equals == first))
            throw Error("options, line " + std::to_string(number) + ": '" + line +
                        "' is neither [section], 'key = value' inside one, nor a # comment");
    }
}
}  // namespace

Options Options::ofProfile(const std::string& name) {
    const auto text = profileTexts().find(name);
    if (text == profileTexts().end()) {
        std::string known;
        for (const auto& profile : profileNames()) known += (known.empty() ? "" : ", ") + profile;
        throw Error("there is no profile '" + name + "'; the profiles are: " + known);
    }
    Options options;
    options.load(text->second);
    return options;
}

void Options::adaptTo(const io::DriveMeta& meta) {
    constexpr double kKittiSweep_s = 0.1;
    odometry.preprocess.vertical_correction_deg = meta.verticalCorrectionDeg;
    odometry.preprocess.deskew = !meta.motionCompensated;
    odometry.preprocess.sweep_s = meta.source == "kitti-raw" ? kKittiSweep_s : 0;
}

std::vector<std::string> Options::profileNames() {
    std::vector<std::string> names;
    for (const auto& [name, text] : profileTexts()) names.push_back(name);
    return names;
}

std::vector<std::pair<std::string, StageOptions*>> Options::stages() {
    return {{"scan", &odometry.preprocess},
            {"normals", &odometry.normals},
            {"bilateral_filter", &odometry.bilateral},
            {"outlier_removal", &odometry.outliers},
            {"mean_shift", &odometry.meanShift},
            {"pattern_registration", &odometry.pattern},
            {"line_cloud", &odometry.lines},
            {"line_registration", &odometry.lineRegistration},
            {"prediction", &odometry.prediction},
            {"plane_tracker", &odometry.tracker},
            {"plane_map", &odometry.planeMap},
            {"plane_registration", &odometry.planes},
            {"moving_objects", &odometry.moving},
            {"segments", &odometry.segments},
            {"graph", &graph},
            {"map", &map}};
}

void Options::load(const std::string& iniText) {
    requireIniLines(iniText);
    const CConfigFileMemory config(iniText);
    std::vector<std::string> sections;
    config.getAllSections(sections);
    const auto known = stages();
    for (const auto& section : sections) {
        const auto stage = std::find_if(known.begin(), known.end(),
                                        [&](const auto& entry) { return entry.first == section; });
        if (stage == known.end()) throw Error("options section [" + section + "] does not exist");
        stage->second->loadFromConfigFile(config, section);
    }
}

void Options::set(const std::string& assignment) {
    const auto dot = assignment.find('.');
    const auto equals = assignment.find('=');
    // A key that begins like a comment or a section would be one.
    if (equals == assignment.npos || dot > equals || dot + 1 == equals ||
        std::string("#;[").find(assignment[dot + 1]) != std::string::npos)
        throw Error("'" + assignment + "' is not of the form section.key=value");
    load("[" + assignment.substr(0, dot) + "]\n" + assignment.substr(dot + 1) + "\n");
}

void Options::write(std::ostream& out) const {
    const char* separator = "";
    // stages() hands out what may be written to; here it is only read.
    for (const auto& [section, stage] : const_cast<Options*>(this)->stages()) {
        out << separator;
        stage->write(out, section);
        separator = "\n";
    }
}

bool Options::sets(const std::string& iniText, const std::string& section, const std::string& key) {
    return CConfigFileMemory(iniText).keyExists(section, key);
}
}  // namespace delio
