#pragma once
#include <mrpt/img/CImage.h>

#include <string>

namespace delio::picture {
/** Throws Error for a name that does not end in .png: to be asked before the work is done. */
void checkPngName(const std::string& path);

/** Writes a .png. Throws Error if that fails, or for a name that does not end in .png. */
void savePng(const mrpt::img::CImage& image, const std::string& path);
}  // namespace delio::picture
