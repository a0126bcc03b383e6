#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "delio/core/odometry_options.h"
#include "odometry/range_image.h"
#include "odometry/tuning.h"

namespace delio::odometry {
/** As alike as two views of one thing from about the same side, by its size (metres). */
bool alike(const Eigen::Vector3f& a, const Eigen::Vector3f& b);

/** Where the objects of a scan are and how large: closely packed, as of most of them nothing else
 *  is asked. Metres, the map's frame. */
class Outlines {
 public:
    std::size_t size() const { return places_[0].size(); }  //!< objects

    /** One more: its place's x is no less than that of the one before. */
    void add(const Eigen::Vector3f& place, const Eigen::Vector3f& size);

    /** An object's place. */
    Eigen::Vector3f place(std::size_t number) const {
        return {places_[0][number], places_[1][number], places_[2][number]};
    }
    /** An object's size. */
    Eigen::Vector3f sizeOf(std::size_t number) const {
        return {sizes_[0][number], sizes_[1][number], sizes_[2][number]};
    }
    /** The numbers from the first one to before the second one: of those whose places are within
     *  `reach` of `x` along the map's first axis. */
    std::pair<std::size_t, std::size_t> about(float x, float reach) const;

    /** Adds those of these numbers whose objects are alike in size. */
    void findAlike(const std::pair<std::size_t, std::size_t>& numbers, const Eigen::Vector3f& size,
                   std::vector<std::size_t>& found) const;

 private:
    std::array<std::vector<float>, 3> places_, sizes_;  //!< an axis each
};

/** Points that stand together on the ground, apart from others. */
struct Segment {
    std::vector<Eigen::Index> points;  //!< which
    Eigen::AlignedBox3f box;           //!< metres, the points' frame
};

/** What stands on the ground about a vehicle, in pieces: points (metres, a frame with z up) higher
 *  above the lowest ones about them than `above_ground`, connected over cells of the ground plane
 *  that touch. What is longer than `max_length` (walls, hedges) or has fewer than `min_points` is
 *  left out. */
std::vector<Segment> segmentsOf(const Eigen::Matrix3Xf& points, const SegmentTuning& options);

/** Finds dynamic objects by free space: what moves. A segment of a scan is one where
 *  - earlier scans saw through most of the place that it takes (it came from elsewhere), or
 *  - it is the third of a row of segments of one size at equal distances in equal times, through
 *    the first two of which this scan sees (it drives ahead, where it hides its way), or goes on
 *    from such a row as it did. */
class DynamicObjects {
 public:
    /** Of no scan yet. */
    explicit DynamicObjects(const DynamicObjectsOptions& options) : options_(options) {}

    /** What a scan shows while its pose is not known. */
    class Sight;
    /** The free space about the sensor, by all points (metres) of a scan. */
    RangeImage freeSpaceOf(const Eigen::Matrix3Xf& all) const {
        return RangeImage(all, options_.cell_deg);
    }
    /** `points`: a thinned view (metres) of those that `freeSpace` is of. `upright` turns their
     *  frame such that z is up. */
    Sight see(const Eigen::Matrix3Xf& points, RangeImage freeSpace,
              const Eigen::Matrix3f& upright = Eigen::Matrix3f::Identity()) const;

    /** Which of the points that see() was given belong to dynamic objects: 1 or 0 each. `pose`:
     *  sensor to map, good to a part of the margin. */
    std::vector<std::uint8_t> detect(Sight sight, const Eigen::Isometry3d& pose, double stamp_s);

    /** The objects that the latest detect() found to move, where they were in earlier scans that
     * did not show it yet: metres, the map's frame. */
    const Eigen::Matrix3Xf& unmasked() const { return unmasked_; }

    /** Keeps the scan that detect() was asked of last, at its final pose, to judge later ones by.
     */
    void remember(const Eigen::Isometry3d& pose);

    /** Forgets all earlier scans. */
    void clear() { views_.clear(); }

 private:
    /** What is kept of a scan: all in its level frame. */
    struct Object {
        Eigen::Matrix3Xf points;
        Eigen::Vector3f centre, size;
        Eigen::Vector3f place = Eigen::Vector3f::Zero();  //!< the centre, in the map's frame
        std::optional<Eigen::Vector3f> velocity;          //!< m/s, in the map's frame
        bool isTold = false;                              //!< that it moves
    };
    using Objects = std::vector<Object>;
    /** A place that an object left behind. */
    struct Left {
        std::size_t view;
        std::size_t object;  //!< of that view's
    };
    /** That an object moves, as the places show that it left behind. */
    struct Track {
        Eigen::Vector3f velocity;
        std::vector<Left> left;
    };
    struct View {
        double stamp_s = 0;
        Eigen::Isometry3f toMap = Eigen::Isometry3f::Identity();  //!< from the level frame
        Eigen::Matrix3f upright = Eigen::Matrix3f::Identity();    //!< sensor's to level frame
        RangeImage image;                                         //!< sensor's frame
        Objects objects;                  //!< of an earlier scan: by their places' x
        Outlines outlines;                //!< of an earlier scan's objects
        std::vector<std::size_t> moving;  //!< those of them whose velocity is known

        void outline();
    };
    bool came(const Object& object) const;
    bool isGone(const Left& left) const;
    std::optional<Left> leftBefore(const Left& then, const Eigen::Vector3f& step,
                                   const Object& object) const;
    void findAlike(const Object& object, const View& view, float farthest, bool all,
                   std::vector<std::size_t>& found) const;
    std::optional<Track> trackOf(const Object& object) const;
    void unmask(const Track& track);
    /** True where scan `by` saw through the place that `object` took in scan `seen`. `minKnown`:
     *  the fraction of the object's points in known places that is required. */
    bool isFree(const Object& object, const View& seen, const View& by, double minKnown) const;

    DynamicObjectsOptions options_;
    View latest_;
    std::deque<View> views_;  //!< earlier scans, latest first
    Eigen::Matrix3Xf unmasked_;
};

/** The image of one scan, in its sensor's frame, its segments and its objects, in the level one. */
class DynamicObjects::Sight {
 private:
    friend class DynamicObjects;
    std::size_t points_ = 0;
    Eigen::Matrix3f upright_ = Eigen::Matrix3f::Identity();
    RangeImage image_;
    std::vector<Segment> segments_;
    Objects objects_;  //!< of the segments
};
}  // namespace delio::odometry
