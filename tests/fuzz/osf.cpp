#include <zlib.h>

#include <cstring>

#include "scans.h"

/** An OSF file, whose checksums are put right: damage behind them is to be read, too. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    constexpr std::size_t kSize = 4, kSum = 4;
    std::string bytes = Input(data, size).rest();
    for (std::size_t at = 0; at + kSize + kSum <= bytes.size();) {
        std::uint32_t block = 0;
        std::memcpy(&block, &bytes[at], kSize);
        if (block > bytes.size() - at - kSize - kSum) break;
        const auto sum = static_cast<std::uint32_t>(
            crc32_z(0, reinterpret_cast<const Bytef*>(&bytes[at]), kSize + block));
        at += kSize + block;
        std::memcpy(&bytes[at], &sum, kSum);
        at += kSum;
    }
    return readScans({fileOf(bytes, "d.osf"), "", "", ""}, delio::io::FileKind::kOsf);
}
