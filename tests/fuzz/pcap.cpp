#include "scans.h"

/** A pcap or pcapng, of a Velodyne or of the Ouster whose json comes before it, with a zero byte
 *  between them. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    Input input(data, size);
    const std::string json = input.cutText();
    const std::string sensor = json.empty() ? "" : fileOf(json, "d.json");
    return readScans({fileOf(input.rest(), "d.pcap"), "", "", sensor}, delio::io::FileKind::kPcap);
}
