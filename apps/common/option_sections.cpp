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
        {"odometry", "choice of the odometry"},
        {"scan", "ranges, vertical correction and de-skewing of scans"},
        {"prediction", "motion model"},
        {"plane_tracker", "scale of the scene, and when a wide search starts"},
        {"point_map", "local point map"},
        {"point_registration", "point-to-point registration (initial alignment)"},
        {"plane_map", "local plane map"},
        {"plane_registration", "point-to-plane registration (refinement)"},
        {"moving_objects", "dynamic objects, excluded from registration and map"},
        {"normals", "surface normals"},
        {"bilateral_filter", "bilateral filter on the normals"},
        {"pattern_registration", "rotation from the pattern of normals"},
        {"outlier_removal", "outlier removal on the sphere of normals"},
        {"mean_shift", "modes of the pattern of normals"},
        {"rotation_in_place", "refinement of the rotation by paired normals"},
        {"line_cloud", "line cloud of a scan"},
        {"line_registration", "translation from the lines"},
        {"point_check", "check of increments by point registration"},
        {"graph", "pose graph"},
        {"map", "keyframes and map points"},
        {"removal", "removal of dynamic points from the map"},
        {"submaps", "submaps between which loops are searched"},
        {"loops", "search for loop closures"},
        {"closures", "acceptance of loop closures"},
        {"place_search", "global localisation in a stored map"},
        {"localisation", "tracking in a stored map"}};
    std::vector<HelpText::Row> rows;
    for (const auto& [section, stage] : stages) rows.push_back({section, about.at(section)});
    return rows;
}
}  // namespace delio::cli
