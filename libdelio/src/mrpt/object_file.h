#pragma once
#include <mrpt/serialization/CSerializable.h>

#include <string>

#include "object_archive.h"

namespace delio::io {
/** Reads one MRPT object from a file, gzip or plain. Throws Error for a file that is missing, holds
 *  anything else than `what` or more than that, holds a class that no such file needs, is cut off
 *  anywhere, or whose compressed data is damaged (by its checksum). */
void loadWhole(const std::string& path, const std::string& what, FileOf file,
               mrpt::serialization::CSerializable& object);

/** Writes one MRPT object into a file, with gzip. Throws Error if that fails; then there is no such
 *  file, or the one that was there before. */
void saveWhole(const mrpt::serialization::CSerializable& object, const std::string& path);
}  // namespace delio::io
