#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include <memory>
#include <string>
#include <vector>

#include "delio/core/stage_options.h"
#include "delio/odometry/step.h"
#include "delio/slam/options.h"

namespace delio {
class Slam;

/** Options of OdometryMapBuilder. */
struct OdometryMapBuilderOptions : public StageOptions {
    std::string profile = "accurate";  //!< of which `stages` are made by loadFromConfigFile()
    double keyframe_distance = 1;      //!< m; a scan becomes a keyframe after this way,
    double keyframe_angle_deg = 30;    //!< or after such a rotation, about any axis
    double map_resolution = 0.1;       //!< m; points of the metric map keep this distance
    Options stages = Options::ofProfile(profile);  //!< of the odometry

    /** From `section`; `stages` become those of the profile, changed by the sections
     *  `section.STAGE`, each a stage of Options. Error as StageOptions, and for an unknown stage.
     */
    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    /** All sections. */
    void saveToConfigFile(mrpt::config::CConfigFileBase& target,
                          const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** DeLiO's odometry wherever an MRPT program builds a map, as with CMetricMapBuilderICP.
 *
 *  Poses are the vehicle's; the first scan gives the origin. LiDAR observations (those that
 *  delio-slam reads from a rawlog) are registered at their `sensorPose`, observations of the class
 *  CObservationIMU, CObservationOdometry and CObservationRobotPose are given to the odometry, and
 * others are passed over. Actions are not used. Externally stored points are loaded. A scan enters
 * the map as a keyframe: its static, de-skewed points, as CObservationPointCloud in the vehicle's
 * frame. Scans that were not registered do not enter it. There is no loop closure: see run::Run.
 *
 *  One thread at a time may call it. Throws Error where an observation cannot be decoded. */
class OdometryMapBuilder : public mrpt::slam::CMetricMapBuilder {
 public:
    /** Options are copied; change `options` of the base class at any time. */
    explicit OdometryMapBuilder(const OdometryMapBuilderOptions& o = {});
    ~OdometryMapBuilder() override;

    /** Begins anew, at the mean of `x0` (null: the origin). Throws Error for a map that is not
     *  empty: StoredMap and Localiser continue one. */
    void initialize(const mrpt::maps::CSimpleMap& initialMap = {},
                    const mrpt::poses::CPosePDF* x0 = nullptr) override;

    /** Processes an observation; false where it was passed over. */
    bool processObservation(const mrpt::obs::CObservation::Ptr& observation);
    /** Processes all of `observations`, in their order. */
    void processActionObservation(mrpt::obs::CActionCollection& action,
                                  mrpt::obs::CSensoryFrame& observations) override;

    /** Result of the odometry for the latest scan. Throws Error before the first one. */
    const Step& latestStep() const;

    /** A CPose3DPDFGaussian: pose of the vehicle; its covariance grows from scan to scan. */
    mrpt::poses::CPose3DPDF::Ptr getCurrentPoseEstimation() const override;
    /** The keyframes with their poses. */
    void getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& map) const override;
    unsigned int getCurrentlyBuiltMapSize() override;  //!< number of keyframes
    /** One CSimplePointsMap: points of the keyframes, metres. Valid until the next observation. */
    const mrpt::maps::CMultiMetricMap* getCurrentlyBuiltMetricMap() const override;
    /** A picture of the points from above, 1024 pixels wide, whose format the extension chooses. */
    void saveCurrentEstimationToImage(const std::string& file, bool unused = true) override;

 private:
    class Keyframes;
    void begin(const Eigen::Isometry3d& start);

    OdometryMapBuilderOptions own_;
    std::shared_ptr<Keyframes> keyframes_;
    std::unique_ptr<Slam> slam_;
    std::size_t scans_ = 0;
};
}  // namespace delio
