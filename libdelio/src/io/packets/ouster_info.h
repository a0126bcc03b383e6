#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace delio::io {
/** Where the fields of an Ouster's packets lie, in bytes; numbers are little-endian. */
struct OusterLayout {
    std::size_t header = 0, footer = 0;  //!< of a packet
    std::size_t columnHeader = 0, columnFooter = 0;
    std::size_t pixel = 0;
    bool legacy = false;          //!< frame and status stand in each column, not in the header
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

/** What an Ouster's json says of the sensor. Metres and radians. */
struct OusterInfo {
    std::string product;  //!< e.g. "OS-1-128"; empty: it does not say
    OusterIds ids;
    std::size_t rows = 0, columns = 0, columnsPerPacket = 16;
    std::size_t columnsUsed = 0;               //!< of a turn: the others are not sent
    std::vector<double> elevations, azimuths;  //!< one a row
    double beamOut_m = 0, beamUp_m = 0;        //!< beam's origin from that of the lidar frame
    Eigen::Matrix4d lidarToSensor = Eigen::Matrix4d::Identity();
    OusterLayout layout;

    std::size_t columnBytes() const {
        return layout.columnHeader + rows * layout.pixel + layout.columnFooter;
    }
    std::size_t packetBytes() const {
        return layout.header + columnsPerPacket * columnBytes() + layout.footer;
    }
};

/** Understands the flat description of firmware 1 and 2 and the nested one of later firmware. Keys
 *  that old firmware leaves out have its defaults; a gen-1 sensor's beams begin 12.163 mm out.
 *  Throws Error, which names `name` and the key, where one is missing or not what it should be. */
OusterInfo readOusterInfo(const std::string& json, const std::string& name);

/** Whether packets of so many bytes may be an Ouster's, whichever it is. */
bool isOusterPacketSize(std::size_t bytes);
}  // namespace delio::io
