#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/earth/fix.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/run_record.h"
#include "delio/slam/listeners.h"

namespace delio {
class LoopCloser;
class MapFollower;
class SpecificForce;
}  // namespace delio

namespace delio::run {
class RowFiles;

/** Settings of a run besides the options of its stages. */
struct RunSettings {
    std::string profile = "accurate";   //!< that the options were made of, for the summary
    std::vector<std::string> command;   //!< for the summary
    std::string sensorLabel = "lidar";  //!< of the observations in map.simplemap
    std::string drive = "drive";        //!< its name in the stored map
    /** Folder of the results. During the run, `folder`/incomplete has scans.csv and the odometry's
     *  trajectory so far, and temporary files. Empty: neither table is written, and temporary files
     *  are in the system's folder. */
    std::string folder;
    bool graph = true;         //!< false: the chain of increments alone, not optimised
    bool map = true;           //!< false: memory grows by the poses alone
    bool keepDynamic = false;  //!< write map_dynamic.ply, the removed dynamic points
    /** A stored map in which the drive is localised; its file, or the folder of the run that made
     *  it. Empty: none. */
    std::string storedMap;
    /** What results call that map; empty: by its path. */
    std::string storedMapName;
    /** Of the vehicle at the first scan in that map, if it is known to some metres. */
    std::optional<Eigen::Isometry3d> initialPose;
    bool extend = false;  //!< extend that map by this drive
    bool update = false;  //!< mark what is gone and new in that map; needs `map`
    /** A drive that is not in the map keeps its own frame, which is no fault. */
    bool mayBeElsewhere = false;
    bool gnss = true;    //!< use GNSS fixes
    bool level = false;  //!< z of the map is up, as the IMU's accelerometer has it
    bool loops = true;   //!< search for loop closures; needs `graph`
    /** Called with every warning. */
    std::function<void(const std::string&)> onWarning;
};

/** Processes one drive: odometry, pose graph, map and records. RunFolder writes the results. */
class Run {
 public:
    /** Error where the options contradict each other, or the stored map cannot be read. */
    Run(const Options& options, const RunSettings& settings);
    ~Run();
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    /** Calibration and true poses, as the drive's reader has them. `truth`: a pose file that
     *  replaces `poses`. `truthIsCam0`: it is KITTI's, otherwise the vehicle's. Throws Error if the
     *  truth cannot be read, or is of cam0 and there is no Tr. */
    void readSideFiles(const io::SideFile& calib, const io::SideFile& poses,
                       const std::string& truth = "", bool truthIsCam0 = true);
    /** The same of the files beside the rawlog `recording`. */
    void readSideFiles(const std::string& recording, const std::string& truth = "",
                       bool truthIsCam0 = true);

    /** One more listener: see Slam. One that fails is named in the record, as its fault or in a
     *  warning. */
    void attach(std::shared_ptr<SlamListener> listener) { slam_.attach(std::move(listener)); }

    /** Takes a sample of the drive's IMU: see Odometry::addImu(). */
    void addImu(const ImuSample& sample);
    /** See Odometry::imuReport(). */
    std::optional<ImuReport> imuReport() const { return slam_.imuReport(); }
    /** Takes a pose by the drive's wheels: see Odometry::addOdometry(). */
    void addOdometry(const OdometrySample& sample) { slam_.addOdometry(sample); }
    /** See Odometry::odometryReport(). */
    std::optional<OdometryReport> odometryReport() const { return slam_.odometryReport(); }

    /** Processes the next scan, which took `read_ms` to read. */
    RunRow process(const Scan& scan, double read_ms = 0);
    /** See Odometry::settle(). */
    void settle() { slam_.settle(); }

    /** Takes GNSS fixes of the drive, with stamps as its scans have them; before finish(). */
    void add(const earth::Fixes& fixes);

    /** Records what a live sensor sent; before finish(). */
    void add(LiveRecord live) { record_.live = std::move(live); }

    /** Records the poses of several LiDARs that were refined, with a warning for those that were
     *  not; before finish(). */
    void add(std::vector<CalibratedSensor> extrinsics);

    /** Pose of the vehicle at the latest scan. */
    struct Pose {
        double stamp_s = 0;  //!< of the scan
        /** Maps coordinates of the vehicle to those of the frame. */
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        bool isInMap = false;  //!< in the frame of the stored map; otherwise of the first scan
    };
    Pose latestPose() const;  //!< after a scan was processed

    /** Records a warning for the summary and calls RunSettings::onWarning. */
    void warn(const std::string& text);
    /** Records the reason why the run ended early or is incomplete; only the first one is kept. */
    void fail(const std::string& fault);

    /** Optimises, evaluates against ground truth if known, and adds warnings. A run without a
     *  registered scan has failed. `complete`: every scan was processed. */
    void finish(bool complete);

    const RunRecord& record() const { return record_; }  //!< results so far
    /** Of the odometry, so far. */
    const io::Trajectory& odometry() const { return slam_.trajectory(); }
    /** Of a run that is finished; they live as long as it does. */
    RunMaps maps() const {
        return {map_ ? &map_->builder() : nullptr, stored_ ? &*stored_ : nullptr,
                settings_.keepDynamic};
    }

 private:
    void findOwnVehicle();
    bool searchesLoops() const;
    places::LoopOptions loopOptions() const;
    void switchOff(const FailedListener& failed, std::size_t scan);
    void optimise();
    void optimiseGraph();
    void closeLoops();
    void level();
    void standUpright();
    void georeference();
    void anchor();
    void store();
    void extend();
    void update();
    Visit visit() const;
    void score();
    evaluation::Comparison compared(const io::Trajectory& vehicle) const;

    RunSettings settings_;
    RunRecord record_;
    std::unique_ptr<RowFiles> rows_;  //!< of the drive so far; null without a folder
    Slam slam_;
    std::shared_ptr<GraphBuilder> graph_;
    std::shared_ptr<MapListener> map_;
    std::shared_ptr<MapFollower> follower_;
    std::shared_ptr<LoopCloser> loops_;  //!< keeps the submaps, too
    std::unique_ptr<SpecificForce> forces_;
    std::optional<MapContent> own_, stored_;  //!< of the drive; and what is written
    earth::Fixes gnssFixes_;
    std::optional<io::Trajectory> truth_;
    bool truthIsCam0_ = true, truthWasAskedFor_ = false;
};

/** Optimises an existing pose graph again. */
RunRecord optimiseAgain(graph::PoseGraph graph, const Options& options,
                        const RunSettings& settings);
}  // namespace delio::run
