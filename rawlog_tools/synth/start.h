#pragma once
#include <cstddef>
#include <memory>

#include "motion.h"

namespace delio::synth {
/** How a drive begins. */
enum class Start {
    kOfSeed,  //!< as the seed has it
    kRest,    //!< standing; it speeds up within kSpeedUp_s
    kMoving   //!< at nearly the full speed of its first kSearch_s
};
constexpr double kSpeedUp_s = 2, kSearch_s = 36;

/** So many scans more than the drive's the world has to reach. */
std::size_t scansBefore(Start start);

/** `motion`, begun otherwise. From rest it goes the same way, with the speed rising evenly to what
 *  it is; moving, it begins later, where the vehicle is fast for the first time. What begins as
 *  asked stays as it is. */
std::shared_ptr<const Motion> begun(std::shared_ptr<const Motion> motion, Start start);
}  // namespace delio::synth
