#pragma once
#include <iosfwd>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "delio/odometry/paper_odometry.h"
#include "delio/odometry/plane_odometry.h"

namespace delio {
/** Which odometry it is. */
struct MethodOptions : public StageOptions {
    std::string method = "planes";

 protected:
    std::vector<OptionField> fields() const override;
};

/** The choice of an odometry, and the options of each. Those of the other one have no effect. */
struct OdometryOptions {
    MethodOptions method;         //!< [odometry]: which of the two
    PlaneOdometryOptions planes;  //!< of the profile `accurate`
    PaperOdometryOptions paper;   //!< of the paper's profiles

    bool isPaper() const { return method.method == "paper"; }  //!< the paper's odometry is chosen
    /** [scan], of the chosen one. */
    const scan::PreprocessOptions& scan() const { return isPaper() ? paper.scan : planes.scan; }
};

/** The odometry that the options choose. Throws Error where two of its options contradict each
 *  other. */
std::unique_ptr<Odometry> makeOdometry(const OdometryOptions& options);

/** Sections and their options, to be changed. */
using StageList = std::vector<std::pair<std::string, StageOptions*>>;
/** Sections and their options. */
using ConstStageList = std::vector<std::pair<std::string, const StageOptions*>>;

/** The stages of a method with the names of their sections, in the order in which a scan goes
 *  through them. */
StageList stagesOf(PlaneOdometryOptions& options);
/** The same of the paper's method. */
StageList stagesOf(PaperOdometryOptions& options);
/** Those of the chosen one, the choice first. */
ConstStageList stagesOf(const OdometryOptions& options);
}  // namespace delio
