#include "palette.h"

#include <mrpt/core/format.h>

#include <array>

namespace delio::evaluation {
namespace {
constexpr std::array<unsigned, 8> kColours = {0x0072b2, 0xe69f00, 0x009e73, 0xaa4499,
                                              0x56b4e9, 0x6b4c1e, 0x222222, 0x999933};
constexpr unsigned kWhiteShare_percent = 68;
}  // namespace

std::string colourOf(std::size_t estimate) {
    return mrpt::format("#%06x", kColours[estimate % kColours.size()]);
}

std::string paleColourOf(std::size_t estimate) {
    const unsigned colour = kColours[estimate % kColours.size()];
    unsigned pale = 0;
    for (const unsigned shift : {16U, 8U, 0U}) {
        const unsigned part = (colour >> shift) & 0xFF;
        pale |= ((part * (100 - kWhiteShare_percent) + 255 * kWhiteShare_percent) / 100) << shift;
    }
    return mrpt::format("#%06x", pale);
}
}  // namespace delio::evaluation
