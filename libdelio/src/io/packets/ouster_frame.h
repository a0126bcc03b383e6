#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ouster_info.h"

namespace delio::io {
/** One turn of an Ouster as it was sent: `columns` columns of `rows` pixels, staggered (pixels of a
 *  column were measured at once). What was not received is 0. */
struct OusterFrame {
    explicit OusterFrame(const OusterInfo& info)
        : ranges_mm(info.rows * info.columns),
          reflectivities(info.rows * info.columns),
          times_ns(info.columns),
          received(info.columns) {}

    std::uint16_t number = 0;
    double received_s = 0;                     //!< Unix time at which its first packet was recorded
    std::vector<std::uint32_t> ranges_mm;      //!< column by column; of the first return
    std::vector<std::uint8_t> reflectivities;  //!< likewise, 255 at most
    std::vector<std::uint64_t> times_ns;       //!< of the sensor's clock, a column
    std::vector<bool> received;                //!< a column
    std::size_t count = 0;                     //!< of columns that were received
};

/** When the columns of a turn were measured. */
struct OusterTimes {
    std::uint64_t start_ns = 0;   //!< of the sensor's clock, at the first column
    std::vector<double> since_s;  //!< from there, one for each column that was received
    std::size_t mended = 0;       //!< columns whose own times cannot be right
};

/** Nothing where no column was received, or the times make no sense. */
std::optional<OusterTimes> timesOf(const OusterFrame& frame);

/** Reads the columns of an Ouster's packets. */
class OusterPacket {
 public:
    /** `bytes`: info.packetBytes() of them. */
    OusterPacket(const OusterInfo& info, const std::uint8_t* bytes) : info_(info), bytes_(bytes) {}

    /** Of the sensor that sent it; none in the profile LEGACY. */
    OusterIds ids() const;
    std::uint16_t frameOf(std::size_t column) const;
    /** Its status says that it was measured. */
    bool valid(std::size_t column) const;
    /** When it was measured, by the sensor's clock. */
    std::uint64_t time_ns(std::size_t column) const;
    /** Where in the turn: 0 to before info.columns, unless the packet is damaged. */
    std::size_t place(std::size_t column) const;
    /** Copies a valid column to its place. */
    void copyTo(OusterFrame& frame, std::size_t column) const;

 private:
    const std::uint8_t* at(std::size_t column) const {
        return bytes_ + info_.layout.header + column * info_.columnBytes();
    }

    const OusterInfo& info_;
    const std::uint8_t* bytes_;
};
}  // namespace delio::io
