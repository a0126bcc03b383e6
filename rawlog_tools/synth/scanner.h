#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "own_vehicle.h"
#include "random.h"
#include "ray_caster.h"
#include "sensor_model.h"
#include "sweep.h"
#include "traffic_caster.h"

namespace delio::synth {
struct ScannerOptions {
    /** Of a range, standard deviation. 0: a perfect instrument, which neither rounds azimuths nor
     *  mixes the echoes of two surfaces. */
    double noise_m = 0.01;
    double ringBias_m = 0;  //!< of the lasers' own constant errors, standard deviation
    bool onVehicle = true;  //!< whose roof hides what is below
    std::uint64_t seed = 1;
    int threads = 1;
    OwnBox own = {};
};

/** A scan with properties of each point. */
struct ScanPoints {
    std::vector<float> xyzi;    //!< KITTI's four floats, in the sensor's frame when it was measured
    std::vector<float> time_s;  //!< from the scan's stamp
    std::vector<std::uint16_t> ring;
    std::vector<std::uint8_t> label;  //!< 1: moving

    std::size_t size() const { return ring.size(); }
};

/** Makes scans: casts the sensor's rays and adds what a real sensor adds. */
class Scanner {
 public:
    /** `traffic`: null where nobody else is on the road. */
    Scanner(const RayCaster& caster, const TrafficCaster* traffic, SensorModel sensor,
            const ScannerOptions& options);

    /** Ring after ring, the top one first, each from straight ahead to the left and round. Depends
     *  on the seed and `scan`, not on the number of threads. */
    ScanPoints scan(const Sweep& sweep, std::size_t scan) const;

 private:
    using Views = std::vector<TrafficCaster::View>;
    /** Properties of one laser, and its firings in a scan. */
    struct Ring {
        std::size_t number;
        double elevation_rad, offset_rad;  //!< offset of its azimuths from the columns'
        double gain, bias_m;
        std::vector<Hit> hits;
    };
    ScanPoints scanRing(const Sweep& sweep, const Views& views, std::size_t scan,
                        std::size_t number) const;
    Ring makeRing(std::size_t number) const;
    void cast(Ring& ring, const Sweep& sweep, const Views& views) const;
    bool isNoticed(const Ring& ring, std::size_t column, std::size_t scan, Random& random) const;
    double measuredRange(const Ring& ring, std::size_t column, Random& random) const;
    double reportedAzimuth(double azimuth_rad) const;

    const RayCaster& caster_;
    const TrafficCaster* traffic_;
    SensorModel sensor_;
    ScannerOptions options_;
};
}  // namespace delio::synth
