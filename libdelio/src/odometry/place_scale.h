#pragma once
#include "delio/odometry/scan.h"
#include "odometry/tuning.h"

namespace delio::odometry {
/** The size of the place beside a street's, and the options at that scale. */
class PlaceScale {
 public:
    /** A street, until the first scan. */
    explicit PlaceScale(const PlaneOdometryOptions& options);

    /** As they were given, for a street. */
    const PlaneOdometryOptions& given() const { return given_; }
    /** At the scale of the place. */
    const ScaledOptions& options() const { return options_; }
    /** 1 for a street, less for a house. */
    double scale() const { return scale_; }
    /** That the latest scan shows. */
    double seen() const { return seen_; }

    /** Takes what the scan shows of its place; use() makes it the scale. */
    void see(const Scan& scan);
    /** True where scans in a row show a place of another size: out of a house into the street. Once
     *  per scan. */
    bool isOther();
    void use(double scale);

 private:
    PlaneOdometryOptions given_;
    ScaledOptions options_;
    double scale_ = 1, seen_ = 1;
    unsigned others_ = 0;  //!< scans in a row that show another scale
};
}  // namespace delio::odometry
