#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "delio/io/scan_reader.h"

namespace delio::io {
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
