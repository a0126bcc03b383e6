#pragma once
#include <Eigen/Geometry>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "delio/slam/slam.h"

namespace delio {
/** Map and trajectory of a drive while it is driven, for a window and a page. Poses are the
 *  odometry's. One point per voxel is kept; where there are too many, the voxels grow. A thread of
 *  its own builds the map: a scan that comes while many wait is left out of it. */
class LiveMap : public SlamListener {
 public:
    struct Point {
        Eigen::Vector3f position;  //!< metres
        float aboveGround;         //!< metres; above the lowest points around when it was seen
    };

    /** How much of the map a viewer has. */
    struct Seen {
        std::uint32_t generation = 0;  //!< of the map; another one begins with no point and pose
        std::size_t points = 0, poses = 0;
    };

    /** What a viewer does not have. */
    struct News {
        Seen from;  //!< numbers of the first of these points and poses
        std::vector<Point> points;
        std::vector<Eigen::Vector3f> trajectory;  //!< places of the vehicle, 0.1 m apart or more
        std::size_t allPoints = 0, allPoses = 0;  //!< of the map by now
        Eigen::Isometry3d vehicle = Eigen::Isometry3d::Identity();  //!< at the last scan
        /** Unit vectors in the map: where the last scan does not show how far the vehicle moved. */
        Eigen::Matrix3Xf weakAxes;
        std::size_t scans = 0;  //!< so far
        bool isEnded = false;   //!< no more scans come
        Seen seen() const {
            return {from.generation, from.points + points.size(), from.poses + trajectory.size()};
        }
    };

    /** `mostPoints`: that are kept, metres: edge of a voxel at first. */
    explicit LiveMap(std::size_t mostPoints = 1500000, double voxel_m = 0.3);
    ~LiveMap() override;
    LiveMap(const LiveMap&) = delete;
    LiveMap& operator=(const LiveMap&) = delete;

    const char* name() const override { return "live_view"; }
    void add(const SlamScan& scan) override;

    /** By any thread: at most so many points that `seen` lacks. */
    News newsSince(const Seen& seen, std::size_t mostPoints) const;
    /** Static points of the latest scan, in the map. */
    Eigen::Matrix3Xf latestScan() const;

    void clear();  //!< another drive begins
    void end();    //!< no more scans come

 private:
    struct Arrived {
        std::size_t node = 0;
        Eigen::Isometry3d pose;
        std::vector<NodePose> corrected;
        Eigen::Matrix3Xf points;  //!< in the vehicle's frame; none where there is no time for them
        Eigen::Matrix3Xf weakAxes;  //!< in the map
    };
    struct Low {  //!< of a cell of the ground: the lowest points, of which one may be noise
        float lowest, second;
    };

    void run();
    void waitForAll();
    void take(const Arrived& scan);
    void correct(const std::vector<NodePose>& corrected);
    void insert(const Arrived& scan);
    void forget(std::size_t firstNode);
    void coarsen();
    template <typename Keeps>
    void keep(const Keeps& keeps);
    std::uint64_t voxelOf(const Eigen::Vector3f& place) const;
    float groundAt(const Eigen::Vector3f& place) const;
    bool isWorthAdding(const Eigen::Isometry3d& pose) const;

    const std::size_t mostPoints_;
    const double firstVoxel_m_;

    std::mutex arrivals_;  //!< guards these; the odometry waits for nothing else
    std::condition_variable changed_;
    std::deque<Arrived> waiting_;
    bool isBusy_ = false, isClosing_ = false;

    mutable std::mutex map_;  //!< guards these
    double voxel_m_;
    std::uint32_t generation_ = 1;
    std::vector<Point> points_;
    std::vector<std::uint32_t> nodes_;  //!< of the scan that each point is of
    std::unordered_set<std::uint64_t> taken_;
    std::unordered_map<std::uint64_t, Low> lows_;
    std::vector<std::pair<std::size_t, Eigen::Vector3f>> trajectory_;  //!< with their nodes
    Eigen::Isometry3d vehicle_ = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d mapped_ = Eigen::Isometry3d::Identity();  //!< of the last scan in the map
    std::size_t scans_ = 0;
    Eigen::Matrix3Xf latest_, weakAxes_;
    bool isEnded_ = false;

    std::thread thread_;
};
}  // namespace delio
