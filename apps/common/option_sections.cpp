#include "option_sections.h"

#include <map>

#include "delio/slam/options.h"

namespace delio::cli {
std::string profileChoice() {
    std::string choice;
    for (const auto& name : Options::profileNames()) choice += (choice.empty() ? "" : "|") + name;
    return choice;
}

std::vector<HelpText::Row> optionSections(const ConstStageList& stages) {
    static const std::map<std::string, std::string> about = {
        {"odometry", "which odometry it is"},
        {"scan", "which points of a scan are used, and their de-skewing"},
        {"prediction", "the motion that is expected"},
        {"plane_tracker", "scan against map: size of the place, and when a scan is searched for"},
        {"point_map", "the map of points"},
        {"point_registration", "registration of points, which places a scan"},
        {"plane_map", "the map of planes"},
        {"plane_registration", "registration of planes, which refines it"},
        {"moving_objects", "what moves and is kept out of registration and map"},
        {"normals", "surface normals"},
        {"bilateral_filter", "smoothing of the normals"},
        {"pattern_registration", "rotation from the pattern of normals on the sphere"},
        {"outlier_removal", "normals that are no part of the pattern"},
        {"mean_shift", "modes of the pattern"},
        {"rotation_in_place", "rotation again, from normals at the same places"},
        {"line_cloud", "the lines of a scan"},
        {"line_registration", "translation from the lines"},
        {"point_check", "increments checked by points"},
        {"graph", "the pose graph"},
        {"map", "keyframes and the points of the map"},
        {"removal", "what moved, taken out of the map after the drive"},
        {"submaps", "the parts of a drive that loops are sought between"},
        {"loops", "where loops are sought"},
        {"closures", "which loops are believed"},
        {"place_search", "the search for a place in a stored map"},
        {"localisation", "following a stored map"}};
    std::vector<HelpText::Row> rows;
    for (const auto& [section, stage] : stages) rows.push_back({section, about.at(section)});
    return rows;
}
}  // namespace delio::cli
