#pragma once

namespace delio::io {
/** Unix times of a sensor's packets. They are those of the sensor's clock, in seconds; the
 *  recorder's shows what that clock counts from. Where the two are more than half a minute apart,
 * the sensor's was never set and counts from the first packet's recording; where it stands or leaps
 * while the recorder's does not, the recorder's goes on. */
class PacketClock {
 public:
    /** `period_s`: after so long the sensor's clock starts at zero again; 0: never. */
    explicit PacketClock(double period_s = 0) : period_s_(period_s) {}

    double timeOf(double clock_s, double received_s);

 private:
    /** The difference nearest to zero. */
    double between(double earlier_s, double later_s) const;

    double period_s_;
    bool started_ = false;
    double start_s_ = 0;  //!< Unix time of the first packet
    double since_s_ = 0;  //!< from there to the packet before: a sum of Unix times would drift
    double clock_s_ = 0, received_s_ = 0;
};
}  // namespace delio::io
