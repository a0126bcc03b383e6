#pragma once
#include <cstdint>
#include <vector>

namespace delio::synth {
/** A place on a path, seen from above. */
struct Station {
    double s = 0;  //!< metres along the path; 0 where the drive begins
    double x = 0, y = 0;
    double yaw = 0;        //!< goes on beyond 180 deg: without jumps
    double curvature = 0;  //!< 1/m, positive to the left
};

/** A stretch over which the curvature goes linearly from that of the piece before to `curvature`.
 */
struct CurvaturePiece {
    double length;
    double curvature;
};

/** Into a curvature, along it and out again: turns by `angle` in all; the clothoids before and
 *  after the arc are `ease` long. */
void appendTurn(std::vector<CurvaturePiece>& pieces, double angle, double radius, double ease);

/** The curve that the vehicle follows. */
class Path {
 public:
    /** Made of clothoids: the curvature has no jumps. It goes through the origin along +x at s = 0.
     *  `begin_s` <= 0: where the first piece begins; the curve before s = 0 must be straight. */
    Path(double begin_s, const std::vector<CurvaturePiece>& pieces);
    /** Through places a few centimetres to decimetres apart, whose `s` rises; it may cross itself
     *  and come back to where it was. */
    explicit Path(const std::vector<Station>& dense);

    double begin() const { return stations_.front().s; }
    double end() const { return stations_.back().s; }
    /** Beyond its ends the path continues straight. */
    Station at(double s) const;

 private:
    std::vector<Station> stations_;  // every kStep metres
};

/** A street drive of at least `length_m`: straights, slight bends and turns of 60-85 deg between
 *  streets. All headings lie within 90 deg of +x: it never returns. The path extends
 *  `kPathMargin_m` before and behind the drive, for the surroundings there. */
Path urbanPath(std::uint64_t seed, double length_m);
constexpr double kPathMargin_m = 200;
}  // namespace delio::synth
