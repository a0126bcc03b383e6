#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace delio::odometry {
/** What a scan says of a place. */
enum class Place {
    kUnknown,  //!< no beam went there, or one ended before
    kFree,     //!< beams went through
    kTaken     //!< a beam ended there
};

/** A range image to be put aside: the rows that hold anything, in centimetres. */
struct PackedRanges {
    int firstRow = 0;                      //!< of the rows that are kept, from below
    std::vector<std::uint16_t> ranges_cm;  //!< row by row from below; 0: nothing was seen
};

/** The nearest range in each direction of a scan: which space it saw to be free. */
class RangeImage {
 public:
    /** Of no scan: knows nothing. */
    RangeImage() : RangeImage(Eigen::Matrix3Xf(3, 0), 180) {}
    /** `points`: metres, sensor's frame. Directions differ by `cell_deg` (degrees of azimuth and of
     *  elevation). */
    RangeImage(const Eigen::Matrix3Xf& points, double cell_deg);
    /** The same image again, to the centimetre, made for many questions: between two rings that are
     *  not far apart the nearer one counts, so that what lies between them is free only where both
     *  went on. */
    RangeImage(const PackedRanges& packed, double cell_deg);

    /** To be put aside. */
    PackedRanges packed() const;

    /** Of one that was packed: between two rings, radians. */
    float ringSpacing() const { return ringSpacing_; }

    /** `point`: in this scan's sensor frame. Free only where the beams of all neighbouring cells
     *  went on by more than `margin` metres; taken where one of them ended within as much. */
    Place at(const Eigen::Vector3f& point, float margin) const;

 private:
    /** Rows and columns of the whole sphere. */
    struct Directions {
        float perRadian;
        int rows, columns;

        int rowOf(float x, float y, float z) const;
        int columnOf(float x, float y) const;
        void see(const Eigen::Ref<const Eigen::Matrix3Xf>& points, int* cells, float* ranges) const;
    };
    /** Of one of the rows that are kept: its place in nearest_. */
    std::size_t cellOf(int row, int column) const {
        return static_cast<std::size_t>(row - firstRow_) *
                   static_cast<std::size_t>(directions_.columns) +
               static_cast<std::size_t>(column);
    }
    std::size_t rows() const {
        return nearest_.size() / static_cast<std::size_t>(directions_.columns);
    }
    /** Of the cells about one and it: calls visit(range) for each where something was seen. */
    template <typename Visit>
    void forNeighbours(int row, int column, const Visit& visit) const;
    Place lookAbout(int row, int column, float range, float margin) const;
    void fillGaps();
    void summarise();

    Directions directions_;
    float ringSpacing_ = 0;
    int firstRow_ = 0;            //!< that is kept
    std::vector<float> nearest_;  //!< metres, row by row from below; 0: nothing was seen
    /** The least of each cell's neighbourhood, negative where too little was seen there to call
     *  anything free, 0 where nothing was. */
    std::vector<float> leastAbout_;
};
}  // namespace delio::odometry
