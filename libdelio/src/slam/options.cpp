#include "delio/slam/options.h"

#include <mrpt/config/CConfigFileMemory.h>

#include <algorithm>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "profile_texts.h"

namespace delio {
using mrpt::config::CConfigFileMemory;

namespace {
/** MRPT's reader silently ignores lines that it does not understand. */
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

/** MRPT expands $env{NAME} and $eval{FORMULA}, and throws if one is not closed. */
CConfigFileMemory configOf(const std::string& text) {
    try {
        return CConfigFileMemory(text);
    } catch (const std::exception& e) {
        throw Error("cannot parse the options: " + plainMessage(e));
    }
}

/** The stages of everything that listens to the odometry. */
template <class List, class AnyOptions>
List listenerStages(AnyOptions& o) {
    return {{"graph", &o.graph},
            {"map", &o.map},
            {"removal", &o.map.removal},
            {"submaps", &o.submaps},
            {"loops", &o.loops},
            {"closures", &o.closures},
            {"place_search", &o.placeSearch},
            {"localisation", &o.localisation}};
}
}  // namespace

Options Options::ofProfile(const std::string& name) {
    const auto text = profileTexts().find(name);
    if (text == profileTexts().end()) {
        std::string known;
        for (const auto& profile : profileNames()) known += (known.empty() ? "" : ", ") + profile;
        throw Error("unknown profile '" + name + "'; choose one of: " + known);
    }
    Options options;
    options.load(text->second);
    options.given_.clear();  // by a user: nothing yet
    return options;
}

std::vector<std::string> Options::profileNames() {
    std::vector<std::string> names;
    for (const auto& [name, text] : profileTexts()) names.push_back(name);
    return names;
}

Options Options::forDrive(const std::string& profile, const std::optional<io::DriveMeta>& meta) {
    Options options = ofProfile(profile);
    if (meta) options.adaptTo(*meta);
    return options;
}

void Options::adaptTo(const io::DriveMeta& meta) {
    constexpr double kKittiSweep_s = 0.1;
    // The paper takes the points as they are.
    planes.scan.vertical_correction_deg = meta.verticalCorrectionDeg;
    for (auto* scan : {&planes.scan, &paper.scan}) {
        scan->deskew = !meta.motionCompensated;
        scan->sweep_s = meta.source == "kitti-raw" ? kKittiSweep_s : 0;
    }
}

StageList Options::allStages() {
    StageList all{{"odometry", &method}};
    for (const auto& stages : {listenerStages<StageList>(*this), stagesOf(planes), stagesOf(paper)})
        all.insert(all.end(), stages.begin(), stages.end());
    return all;
}

ConstStageList Options::stages() const {
    auto used = stagesOf(*this);
    const auto others = listenerStages<ConstStageList>(*this);
    used.insert(used.end(), others.begin(), others.end());
    return used;
}

void Options::load(const std::string& iniText) {
    requireIniLines(iniText);
    const CConfigFileMemory config = configOf(iniText);
    std::vector<std::string> sections;
    config.getAllSections(sections);
    const auto known = allStages();
    for (const auto& section : sections) {
        bool exists = false;
        for (const auto& [name, stage] : known) {
            if (name != section) continue;
            stage->loadFromConfigFile(config, section);
            exists = true;
        }
        if (!exists) throw Error("options section [" + section + "] does not exist");
        given_.insert(section);
    }
}

void Options::set(const std::string& assignment) {
    const auto dot = assignment.find('.');
    const auto equals = assignment.find('=');
    // A key that begins like a comment or a section would be one.
    if (equals == assignment.npos || dot > equals || dot + 1 == equals ||
        std::string("#;[").find(assignment[dot + 1]) != std::string::npos)
        throw Error("'" + assignment + "' does not have the form section.key=value");
    load("[" + assignment.substr(0, dot) + "]\n" + assignment.substr(dot + 1) + "\n");
}

void Options::check() const {
    const auto used = stages();
    for (const auto& [section, stage] : used) stage->check(section);
    for (const auto& section : given_)
        if (std::none_of(used.begin(), used.end(),
                         [&](const auto& stage) { return stage.first == section; }))
            throw Error("options section [" + section + "] has no effect: odometry.method is '" +
                        method.method + "'");
}

void Options::write(std::ostream& out) const {
    const char* separator = "";
    for (const auto& [section, stage] : stages()) {
        out << separator;
        stage->write(out, section);
        separator = "\n";
    }
}

bool Options::sets(const std::string& iniText, const std::string& section, const std::string& key) {
    return configOf(iniText).keyExists(section, key);
}
}  // namespace delio
