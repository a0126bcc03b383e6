#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "delio/core/error.h"
#include "delio/slam/options.h"

// Options that do not go together.
namespace {
using namespace delio;

Options with(const std::string& profile, const std::vector<std::string>& assignments) {
    Options options = Options::ofProfile(profile);
    for (const auto& assignment : assignments) options.set(assignment);
    return options;
}

/** The one line of the fault; empty without. */
template <class Act>
std::string faultOf(const Act& act) {
    try {
        act();
    } catch (const Error& e) {
        const std::string fault = e.what();
        EXPECT_EQ(fault.find('\n'), fault.npos) << fault;
        return fault;
    }
    return "";
}

std::string checkFault(const Options& options) {
    return faultOf([&] { options.check(); });
}

std::string odometryFault(const Options& options) {
    return faultOf([&] { makeOdometry(options); });
}

/** Assignments that contradict each other, and the options that the fault has to name. */
struct Contradiction {
    std::string profile;
    std::vector<std::string> assignments;
    std::string one, other;
    bool ofOdometry;
};

const Contradiction kContradictions[] = {
    {"accurate", {"scan.min_range=101"}, "scan.min_range (101)", "scan.max_range (100)", true},
    {"paper", {"scan.max_range=2"}, "scan.min_range (2.5)", "scan.max_range (2)", true},
    {"paper",
     {"pattern_registration.last_kernel_deg=9"},
     "pattern_registration.last_kernel_deg (9)",
     "pattern_registration.kernel_deg (8)",
     true},
    {"accurate",
     {"point_registration.last_kernel=0.5"},
     "point_registration.last_kernel (0.5)",
     "point_registration.least_kernel (0.3)",
     true},
    {"accurate", {"map.min_range=70"}, "map.min_range (70)", "map.max_range (60)", false},
    {"paper", {"map.max_range=1"}, "map.min_range (2.5)", "map.max_range (1)", false},
};

TEST(OptionsCheck, NamesBothOptionsThatContradictEachOther) {
    for (const auto& [profile, assignments, one, other, ofOdometry] : kContradictions) {
        const Options options = with(profile, assignments);
        const auto fault = checkFault(options);
        EXPECT_NE(fault.find(one), fault.npos) << fault;
        EXPECT_NE(fault.find(other), fault.npos) << fault;
        EXPECT_EQ(odometryFault(options), ofOdometry ? fault : "");
    }
}

TEST(OptionsCheck, TakesWhatIsJustAllowed) {
    for (const auto& [profile, assignments] :
         std::vector<std::pair<std::string, std::vector<std::string>>>{
             {"accurate", {"scan.min_range=100"}},
             {"accurate", {"plane_registration.last_kernel=0.5"}},
             {"paper", {"pattern_registration.last_kernel_deg=8"}},
             {"accurate", {"map.min_range=60"}},
             // No kernel: nearest neighbours.
             {"paper", {"pattern_registration.kernel_deg=0"}},
             // Of two that change one comes first.
             {"accurate", {"scan.min_range=120", "scan.max_range=150"}},
             {"accurate", {"map.min_range=70", "map.max_range=90"}}}) {
        const Options options = with(profile, assignments);
        EXPECT_EQ(checkFault(options), "");
        EXPECT_EQ(odometryFault(options), "");
    }
}

// What is set and has no effect is a mistake.
TEST(OptionsCheck, NamesASectionOfTheOtherOdometry) {
    const auto ofOne = [](const std::string& assignment, const std::string& own,
                          const std::string& ownMethod, const std::string& other,
                          const std::string& otherMethod) {
        const auto section = "[" + assignment.substr(0, assignment.find('.')) + "]";
        const auto fault = checkFault(with(other, {assignment}));
        EXPECT_NE(fault.find(section), fault.npos) << fault;
        EXPECT_NE(fault.find("odometry.method is '" + otherMethod + "'"), fault.npos) << fault;
        EXPECT_EQ(checkFault(with(own, {assignment})), "");
        // The method may come later.
        EXPECT_EQ(checkFault(with(other, {assignment, "odometry.method=" + ownMethod})), "");
    };
    for (const std::string assignment : {"outlier_removal.alpha=2", "mean_shift.window_deg=3",
                                         "line_cloud.seed=3", "line_registration.centroids=true"})
        ofOne(assignment, "paper", "paper", "accurate", "planes");
    for (const std::string assignment :
         {"plane_tracker.lost_share=0.9", "plane_map.radius=70", "plane_registration.search_step=2",
          "moving_objects.enabled=false", "plane_map.levels=3"})
        ofOne(assignment, "accurate", "planes", "paper", "paper");
}
}  // namespace
