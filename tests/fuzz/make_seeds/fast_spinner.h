#pragma once
#include "pcap_writer.h"
#include "spinner.h"

namespace delio::fuzz {
/** A turn of a Velodyne in a packet. */
inline spinner_test::Spinner fastSpinner() {
    auto spinner = spinner_test::vlp16();
    spinner.turn = 3000;
    return spinner;
}

inline test::Bytes velodynePacket() {
    const auto scan = fastSpinner().scan();
    const auto* from = reinterpret_cast<const std::uint8_t*>(&scan.scan_packets.at(0));
    return {from, from + 1206};
}

}  // namespace delio::fuzz
