#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "beam_angles.h"

namespace delio::io {
/** When the lasers of a packet fire, ns from the packet's time. */
struct HesaiFiring {
    int block_ns = 0;           //!< of the block that the packet's time is of
    int next_ns = 0;            //!< from one azimuth to the next
    bool ofLast = true;         //!< the packet's time is that of its last block, not of its first
    std::vector<int> laser_ns;  //!< of each laser, from its block's time
    /** The same of every other azimuth where the lasers take turns; empty: they do not. */
    std::vector<int> other_ns;
    /** In the operational state 0, high resolution, azimuths follow each other after so long, and
     *  lasers fire at their times modulo it; 0: there is one state only. */
    int fine_ns = 0;
};

/** A Hesai and the layout of its packets; places are bytes from the packet's begin. */
struct HesaiModel {
    std::string name;  //!< e.g. "PandarXT-32"
    std::size_t bytes = 0, lasers = 0, blocks = 0;
    std::size_t bodyAt = 0;     //!< of the first block
    std::size_t azimuthAt = 0;  //!< within a block; its returns follow
    std::size_t returnBytes = 3;
    std::size_t unitAt = 0;             //!< of the unit of distances, mm; 0: it is 4 mm
    std::size_t modeAt = 0;             //!< of the return mode
    std::size_t dateAt = 0;             //!< of year, month, day, hour, minute, second
    std::size_t clockAt = 0;            //!< of the microseconds of the second
    std::size_t loopAt = 0;             //!< of the bit that selects the lasers that fire; 0: all do
    std::size_t stateAt = 0;            //!< of the operational state, where `firing.fine_ns` is set
    std::uint8_t flags = 0;             //!< of the header: the parts that its packets have
    double minRange = 0, maxRange = 0;  //!< metres
    HesaiFiring firing;
    std::vector<BeamAngles> angles;  //!< the maker's default ones
};

/** Models whose packets name their parts by flags in the header: Pandar128 and OT128, each with and
 *  without functional safety and confidences. `bytes` is without the other parts. */
std::vector<HesaiModel> hesaiModelsWithParts();
/** The one of them that sent a packet, which is of a size that one can have; null: none did. */
const HesaiModel* hesaiModelWithParts(const std::vector<HesaiModel>& models,
                                      const std::uint8_t* packet, std::size_t bytes);
/** True where its packet can have so many bytes. */
bool fitsWithParts(const HesaiModel& model, std::size_t bytes);

/** The model that sent a data packet; null where none did. Throws Error for one that is known but
 *  not decoded. */
const HesaiModel* hesaiModel(const std::uint8_t* packet, std::size_t bytes);
/** Returns of each laser that a packet of this mode has, in consecutive blocks. Throws Error. */
std::size_t returnsOfHesai(std::uint8_t mode);
/** True where a packet of a Hesai, decoded or not, can have so many bytes. */
bool isHesaiSize(std::size_t bytes);
}  // namespace delio::io
