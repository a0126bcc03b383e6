#pragma once

#include <memory>
#include <optional>

#include "delio/core/odometry_options.h"
#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/step.h"
#include "delio/odometry/wheels.h"

namespace delio {
/** LiDAR odometry, one scan after the other, rotation and translation decoupled. See
 * makeOdometry(). */
class Odometry {
 public:
    virtual ~Odometry() = default;

    /** Registers the next scan of the drive. A scan that cannot be registered (empty, too few
     *  surfaces) gives the prediction, and says so. */
    virtual Step process(const Scan& scan) = 0;

    /** Does what the next process() would do first: the latest scan enters the map, and the first
     *  scans of a drive are registered again. Not needed: it shortens the time from the next scan
     *  to its pose, for a program that waits for a live sensor. The results are the same. */
    virtual void settle() {}

    /** Takes a sample of the drive's IMU. Samples are used by their stamps: those up to 0.1 s after
     *  the last point of a scan have to be added before process() gets the scan, in any order;
     *  later ones wait, up to 200 000 of them. Not to be called during process(). An odometry that
     *  uses no IMU ignores them (the paper's profiles). */
    virtual void addImu(const ImuSample& sample);

    /** What was found out about the IMU so far; nothing: no sample came, or none is used. */
    virtual std::optional<ImuReport> imuReport() const;

    /** Takes a pose by the drive's wheels, or by another odometry of the vehicle: a loose prior for
     *  the translation that the scans do not show, whose weight follows from its agreement with
     *  them. As addImu(). */
    virtual void addOdometry(const OdometrySample& sample);

    /** What was found out about the wheels so far; nothing: no sample came, or none is used. */
    virtual std::optional<OdometryReport> odometryReport() const;

    /** Box about parts of the own vehicle, in the sensor's frame, metres: they stayed where they
     *  are while the sensor moved, and are left out since. Empty: none were found. */
    virtual Eigen::AlignedBox3d ownVehicle() const { return {}; }
};

/** The odometry that the options choose. Throws Error where two of its options contradict each
 *  other. */
std::unique_ptr<Odometry> makeOdometry(const OdometryOptions& options);
}  // namespace delio
