#pragma once
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/scan.h"
#include "findings.h"

namespace delio::io {
/** A return as a packet has it, in the sensor's frame. */
struct PacketPoint {
    float x = 0, y = 0, z = 0;  //!< metres
    float intensity = 0;        //!< 0 to 1
    std::uint16_t ring = 0;
    float after_s = 0;  //!< from its block's time to its laser's
};

/** Makes scans, a turn of the sensor each, of the blocks of its packets. Turns begin where the
 *  azimuth passes 0, in either sense. What is there of the first and the last turn is a scan if it
 *  is at least half of one. */
class TurnBuilder {
 public:
    /** What is added from here on belongs to a block that was measured at `time_s` (Unix) at the
     *  azimuth `turns`, of which one is the whole circle, and any more are the same. */
    void block(double turns, double time_s);
    void add(const PacketPoint& point) {
        if (count_ == rings_.size()) makeRoom();
        cloud_->setPointFast(count_, point.x, point.y, point.z);
        cloud_->setPointColor_fast(count_, point.intensity, 0, 0);  // where MRPT keeps intensities
        rings_[count_] = point.ring;
        times_s_[count_++] = point.after_s;
    }
    /** There are no more blocks. Throws Error where there were some, but no scan was made of them;
     *  `sensor` is its name. */
    void finish(const std::string& sensor);
    std::optional<Scan> take();
    std::vector<std::string> findings() const;

 private:
    struct Block {
        double place = 0;       //!< part of a turn since the turn began
        double time_s = 0;      //!< Unix
        std::size_t first = 0;  //!< of its points
    };
    bool passes(double turns);
    void endTurn(bool partial);
    void makeRoom();
    std::vector<double> startsOfBlocks();
    Scan takeScan(const std::vector<double>& starts_s);

    std::vector<Block> blocks_;
    /** Points of this turn, with room for more; times count from those of their blocks. */
    mrpt::maps::CPointsMapXYZI::Ptr cloud_ = mrpt::maps::CPointsMapXYZI::Create();
    std::vector<std::uint16_t> rings_;
    std::vector<float> times_s_;
    std::size_t count_ = 0, most_ = 0;  //!< points of this turn, of the largest turn before
    double azimuth_ = -1;               //!< of the last block; negative: none
    double turned_ = 0;                 //!< since the first block of all
    double begin_ = 0, lower_ = 0;  //!< where this turn began, where its circle begins; as turned_
    double inAll_ = 0;              //!< turned in turns that made no scan
    bool isFirst_ = true;           //!< the recording may begin within this turn
    std::size_t taken_ = 0, made_ = 0;  //!< blocks, scans
    Happened mended_, untimed_;
    std::deque<Scan> scans_;
};
}  // namespace delio::io
