#pragma once
#include <cstdint>

namespace delio::io {
/** Unix times of a Velodyne's packets. Its clock, microseconds since the full hour, tells them; the
 *  hour is that of the recorder. Where that is more than half a minute off, the clock was never set
 *  and counts from the first packet's recording; where it stands or leaps while the recorder's does
 *  not, the recorder's goes on.
 */
class VelodyneClock {
 public:
    double timeOf(std::uint32_t clock_us, double received_s);

 private:
    bool started_ = false;
    double start_s_ = 0;  //!< Unix time of the first packet
    double since_s_ = 0;  //!< from there to the packet before: a sum of Unix times would drift
    double clock_s_ = 0, received_s_ = 0;
};
}  // namespace delio::io
