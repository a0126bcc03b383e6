#include "delio/picture/png.h"

#include <png.h>

#include <cstdio>
#include <filesystem>

#include "delio/core/error.h"
#include "delio/files/output_file.h"

namespace delio::picture {
void checkPngName(const std::string& path) {
    if (std::filesystem::path(path).extension() != ".png")
        throw Error("cannot write '" + path + "': pictures are PNG, so give it a name in .png");
}

void savePng(const mrpt::img::CImage& image, const std::string& path) {
    checkPngName(path);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.getWidth());
    png.height = static_cast<png_uint_32>(image.getHeight());
    png.format = PNG_FORMAT_BGR;
    png.flags = PNG_IMAGE_FLAG_FAST;
    // Not MRPT's writer: it tells stderr of a full disk by itself, or nobody.
    io::replaceFile(path, [&](const std::string& temporary) {
        std::FILE* const file = std::fopen(temporary.c_str(), "wb");
        if (!file) return false;
        const int written =
            png_image_write_to_stdio(&png, file, 0, image.ptrLine<std::uint8_t>(0),
                                     static_cast<png_int_32>(image.getRowStride()), nullptr);
        return (std::fclose(file) == 0) && written != 0;
    });
}
}  // namespace delio::picture
