#pragma once
#include <mrpt/maps/CPointsMapXYZI.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/recordings/scan_reader.h"
#include "findings.h"

namespace delio::io {
/** Byte offsets of the fields in Ouster packets; numbers are little-endian. */
struct OusterLayout {
    std::size_t header = 0, footer = 0;  //!< of a packet
    std::size_t columnHeader = 0, columnFooter = 0;
    std::size_t pixel = 0;
    bool legacy = false;          //!< frame and status are in each column, not in the header
    bool safety = false;          //!< the header is that of functional safety (FUSA)
    std::size_t rangeBytes = 4;   //!< of the pixel's first field
    std::uint32_t rangeMask = 0;  //!< of that
    std::uint32_t rangeUnit_mm = 1;
    std::size_t reflectivityAt = 0;
    std::size_t reflectivityBytes = 1;
};

/** Which sensor it is, and which of its starts or changes of configuration; 0: not known. */
struct OusterIds {
    std::uint64_t serial = 0;          //!< prod_sn
    std::uint32_t initialization = 0;  //!< initialization_id

    /** No id that both know differs, as Ouster's SDK has it. */
    bool fit(const OusterIds& other) const {
        const auto same = [](auto one, auto two) { return one == 0 || two == 0 || one == two; };
        return same(serial, other.serial) && same(initialization, other.initialization);
    }
};

/** Metadata of an Ouster sensor (json). Metres and radians. */
struct OusterInfo {
    std::string product;  //!< e.g. "OS-1-128"; empty: it does not say
    OusterIds ids;
    std::size_t rows = 0, columns = 0, columnsPerPacket = 16;
    std::size_t columnsUsed = 0;               //!< of a turn: the others are not sent
    std::vector<double> elevations, azimuths;  //!< one a row
    double beamOut_m = 0, beamUp_m = 0;        //!< beam's origin from that of the lidar frame
    Eigen::Matrix4d lidarToSensor = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d imuToSensor = Eigen::Matrix4d::Identity();
    std::size_t imuSamples = 0;    //!< in a packet; 0: there is one, in a packet of 48 bytes
    std::vector<int> pixelShifts;  //!< columns by which images shift each row; empty: not known
    OusterLayout layout;

    /** e.g. "Ouster OS-1-128". */
    std::string sensor() const { return product.empty() ? "Ouster" : "Ouster " + product; }

    std::size_t columnBytes() const {
        return layout.columnHeader + rows * layout.pixel + layout.columnFooter;
    }
    std::size_t packetBytes() const {
        return layout.header + columnsPerPacket * columnBytes() + layout.footer;
    }
};

/** Reads the flat json of firmware 1 and 2 and the nested one of later firmware. Keys missing in
 *  old firmware have its defaults; a gen-1 sensor's beams begin 12.163 mm out. Throws Error, which
 *  names `name` and the key, where one is missing or not what it should be. */
OusterInfo readOusterInfo(const std::string& json, const std::string& name);

/** A sample of an Ouster's IMU. */
struct OusterImu {
    std::uint64_t time_ns = 0;     //!< of the angular velocity, by the sensor's clock
    Eigen::Vector3d acceleration;  //!< m/s^2
    Eigen::Vector3d rate;          //!< rad/s
};
/** Appends the samples of a packet of the sensor's IMU: one in 48 bytes, or several of firmware 3.2
 *  and later. False where it is another packet. */
bool addOusterImu(const OusterInfo& info, const std::uint8_t* payload, std::size_t bytes,
                  std::vector<OusterImu>& samples);

/** True if packets of this size can come from an Ouster. */
bool isOusterPacketSize(std::size_t bytes);

/** Points of a turn's first columns. */
struct OusterPoints {
    mrpt::maps::CPointsMapXYZI::Ptr points;  //!< with room for the whole turn
    std::vector<std::uint16_t> rings;        //!< likewise
    std::vector<std::size_t> ends;           //!< number of points up to each received column
    std::size_t columns = 0;                 //!< received or not
    bool isWrong = false;                    //!< one of the columns came later, or again
};

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
    OusterPoints prepared;                     //!< see OusterScans::prepare()
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
    /** Its lower 16 bits. */
    std::uint16_t frameOf(std::size_t column) const;
    /** Its status says that it was measured. */
    bool valid(std::size_t column) const;
    /** When it was measured, by the sensor's clock. */
    std::uint64_t time_ns(std::size_t column) const;
    /** Column number in the revolution: less than info.columns, unless the packet is damaged. */
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

/** Directions of all pixels of an Ouster, as tables that convert ranges to points in the sensor's
 *  frame (x forward, away from the connector). */
class OusterBeams {
 public:
    explicit OusterBeams(const OusterInfo& info);

    /** Metres; `pixel` counts column by column. */
    Eigen::Vector3f point(std::size_t pixel, std::uint32_t range_mm) const {
        const float along = 1e-3F * static_cast<float>(range_mm) - beamOrigin_m_;
        return along * directions_[pixel] + origins_[pixel / rows_];
    }

 private:
    std::size_t rows_;
    float beamOrigin_m_;                       //!< ranges count from the lidar's origin
    std::vector<Eigen::Vector3f> directions_;  //!< a pixel
    std::vector<Eigen::Vector3f> origins_;     //!< a column
};

/** Makes scans of the turns of one sensor. Points come column by column, so in the order of time,
 *  and upper rows first; their intensity is the reflectivity, 255 being 1. Columns that were not
 *  received and pixels without a return are left out. */
class OusterScans {
 public:
    /** `info` has to live on. */
    explicit OusterScans(const OusterInfo& info) : info_(info), beams_(info) {}

    /** After a column was received: makes points of those before it, so that little is left to do
     *  when the last one comes. */
    void prepare(OusterFrame& frame, std::size_t column) const;
    /** Takes the points of the turn. */
    Scan scanOf(OusterFrame& frame);
    std::size_t made() const { return made_; }
    /** Stamps as those of scans: nothing, and `waiting` stays, before the first one is made. */
    std::vector<ImuSample> takeImu(std::vector<OusterImu>& waiting) const;
    std::vector<std::string> findings() const;

 private:
    /** Makes points of the columns before `end`. */
    void extend(OusterFrame& frame, std::size_t end) const;
    /** Unix time at which the turn began. */
    double stampOf(const OusterFrame& frame, const std::optional<OusterTimes>& times);

    const OusterInfo& info_;
    OusterBeams beams_;
    std::optional<double> clockOffset_s_;  //!< of a clock that does not keep Unix time
    double delay_s_ = 0;                   //!< from a turn's begin to its recording
    std::size_t made_ = 0;
    Happened mended_, untimed_;
};

/** The json beside `recording` (a file or folder) that describes its Ouster: that of the same name,
 *  or else, of all jsons that name beams and fit `packet`, the one whose name has the most in
 * common with the recording's from the beginning on (as Ouster's SDK has it). `packet`: one of its
 * data packets, of `bytes`; none: all fit. Throws Error, which does not name the recording, where
 * there are several such (it lists them) or none. */
SideFile ousterJsonBeside(const std::string& recording, const std::uint8_t* packet,
                          std::size_t bytes);

/** How many characters two names share from the beginning on. */
std::size_t inCommon(const std::string& one, const std::string& other);
}  // namespace delio::io
