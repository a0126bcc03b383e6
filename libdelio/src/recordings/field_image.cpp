#include "field_image.h"

#include <zlib.h>
#include <zstd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>

#include "delio/core/error.h"
#include "packet_bytes.h"

namespace delio::io {
namespace {
using Raw = std::vector<std::uint8_t>;

const std::uint8_t* bytesOf(std::string_view text) {
    return reinterpret_cast<const std::uint8_t*>(text.data());
}

void checkSize(std::size_t rows, std::size_t columns, const FieldImage& image) {
    if (rows != image.rows || columns != image.columns)
        throw Error("an image of " + std::to_string(rows) + " by " + std::to_string(columns) +
                    " pixels is not of the sensor's " + std::to_string(image.rows) + " by " +
                    std::to_string(image.columns));
}

constexpr std::string_view kPng{"\x89PNG\r\n\x1a\n", 8};

struct Png {
    std::size_t pixel = 0;  //!< bytes
    bool isBigEndian = false;
    std::string packed;  //!< of all its IDAT chunks
};

/** The numbers of an IHDR chunk behind width and height: bits, colours, packing, filter, order. */
void takeHeader(const std::uint8_t* header, Png& png) {
    constexpr std::uint8_t kGrey = 0, kRgb = 2, kRgba = 6;
    const std::uint8_t bits = header[0], colours = header[1];
    if (bits == 8 && colours == kGrey) png.pixel = 1;
    if (bits == 16 && colours == kGrey) png.pixel = 2;
    if (bits == 8 && colours == kRgb) png.pixel = 3;
    if (bits == 8 && colours == kRgba) png.pixel = 4;
    png.isBigEndian = bits == 16;
    if (png.pixel == 0 || header[2] != 0 || header[3] != 0 || header[4] != 0)
        throw Error("a PNG of an unknown kind of pixels");
}

Png readPng(std::string_view coded, const FieldImage& image) {
    constexpr std::size_t kChunk = 12, kHeader = 13;  // bytes of length, type and sum
    Png png;
    for (std::size_t at = kPng.size(); at + kChunk <= coded.size();) {
        const std::size_t length = bigEndian(bytesOf(coded) + at, 4);
        const std::string_view type = coded.substr(at + 4, 4);
        if (length > coded.size() - at - kChunk) throw Error("a PNG is cut off");
        const std::string_view data = coded.substr(at + 8, length);
        if (type == "IHDR" && length == kHeader) {
            checkSize(bigEndian(bytesOf(data) + 4, 4), bigEndian(bytesOf(data), 4), image);
            takeHeader(bytesOf(data) + 8, png);
        } else if (type == "IDAT") {
            png.packed += data;
        }
        at += kChunk + length;
    }
    if (png.pixel == 0) throw Error("a PNG has no header");
    return png;
}

std::uint8_t nearestOf(int left, int above, int aboveLeft) {
    const int guess = left + above - aboveLeft;
    const int toLeft = std::abs(guess - left), toAbove = std::abs(guess - above),
              toBoth = std::abs(guess - aboveLeft);
    if (toLeft <= toAbove && toLeft <= toBoth) return static_cast<std::uint8_t>(left);
    return static_cast<std::uint8_t>(toAbove <= toBoth ? above : aboveLeft);
}

/** Adds to a row what its filter subtracted (PNG, section 9). `above`: zeros for the first row. */
void unfilter(std::uint8_t filter, std::uint8_t* row, const std::uint8_t* above, std::size_t bytes,
              std::size_t pixel) {
    enum Filter : std::uint8_t { kNone, kLeft, kAbove, kMean, kNearest };
    if (filter > kNearest) throw Error("a PNG has an unknown filter");
    for (std::size_t i = 0; filter != kNone && i < bytes; ++i) {
        const int left = i < pixel ? 0 : row[i - pixel],
                  aboveLeft = i < pixel ? 0 : above[i - pixel];
        int add = left;
        if (filter == kAbove) add = above[i];
        if (filter == kMean) add = (left + above[i]) / 2;
        if (filter == kNearest) add = nearestOf(left, above[i], aboveLeft);
        row[i] = static_cast<std::uint8_t>(row[i] + add);
    }
}

void decodePng(std::string_view coded, FieldImage& image) {
    const Png png = readPng(coded, image);
    const std::size_t width = image.columns * png.pixel;
    Raw raw(image.rows * (1 + width));
    uLongf size = raw.size();
    if (uncompress(raw.data(), &size, bytesOf(png.packed), png.packed.size()) != Z_OK ||
        size != raw.size())
        throw Error("a PNG is damaged");
    const Raw zeros(width);
    const std::uint8_t* above = zeros.data();
    for (std::size_t r = 0; r < image.rows; ++r) {
        std::uint8_t* const row = &raw[r * (1 + width) + 1];
        unfilter(row[-1], row, above, width, png.pixel);
        for (std::size_t c = 0; c < image.columns; ++c) {
            const std::uint8_t* const pixel = row + c * png.pixel;
            image.pixels.push_back(png.isBigEndian
                                       ? static_cast<std::uint32_t>(bigEndian(pixel, png.pixel))
                                       : littleEndian(pixel, png.pixel));
        }
        above = row;
    }
    image.isShifted = true;
}

constexpr std::uint32_t kZpng = 0xFBF8;
constexpr std::size_t kZpngHeader = 8;

/** Pixels of 1 or 2 bytes: each byte is a difference from the pixel before. */
void sumBytes(const Raw& raw, std::size_t pixel, FieldImage& image) {
    std::size_t at = 0;
    for (std::size_t r = 0; r < image.rows; ++r) {
        std::array<std::uint8_t, 2> sums{};
        for (std::size_t c = 0; c < image.columns; ++c) {
            for (std::size_t i = 0; i < pixel; ++i)
                sums[i] = static_cast<std::uint8_t>(sums[i] + raw[at++]);
            image.pixels.push_back(littleEndian(sums.data(), pixel));
        }
    }
}

/** Pixels of 3 or 4 bytes: a plane each holds the differences of the third byte, of the second from
 *  it, of the second from the first, and of the fourth. */
void sumPlanes(const Raw& raw, std::size_t pixel, FieldImage& image) {
    const std::size_t plane = image.rows * image.columns;
    std::size_t at = 0;
    for (std::size_t r = 0; r < image.rows; ++r) {
        std::array<std::uint8_t, 4> sums{};
        for (std::size_t c = 0; c < image.columns; ++c, ++at) {
            const unsigned third = raw[at], second = raw[plane + at] + third,
                           first = second - raw[2 * plane + at],
                           fourth = pixel == 4 ? raw[3 * plane + at] : 0U;
            sums = {static_cast<std::uint8_t>(sums[0] + first),
                    static_cast<std::uint8_t>(sums[1] + second),
                    static_cast<std::uint8_t>(sums[2] + third),
                    static_cast<std::uint8_t>(sums[3] + fourth)};
            image.pixels.push_back(littleEndian(sums.data(), pixel));
        }
    }
}

void decodeZpng(std::string_view coded, FieldImage& image) {
    const std::uint8_t* const header = bytesOf(coded);
    checkSize(littleEndian(header + 4, 2), littleEndian(header + 2, 2), image);
    const std::size_t pixel = std::size_t{header[6]} * header[7];
    if (pixel == 0 || pixel > 4) throw Error("a ZPNG of an unknown kind of pixels");
    Raw raw(image.rows * image.columns * pixel);
    const std::size_t size =
        ZSTD_decompress(raw.data(), raw.size(), header + kZpngHeader, coded.size() - kZpngHeader);
    if (ZSTD_isError(size) != 0 || size != raw.size()) throw Error("a ZPNG is damaged");
    if (pixel <= 2)
        sumBytes(raw, pixel, image);
    else
        sumPlanes(raw, pixel, image);
}
}  // namespace

FieldImage fieldImageOf(std::string_view coded, std::size_t rows, std::size_t columns) {
    FieldImage image;
    image.rows = rows;
    image.columns = columns;
    image.pixels.reserve(rows * columns);
    if (coded.substr(0, kPng.size()) == kPng)
        decodePng(coded, image);
    else if (coded.size() >= kZpngHeader && littleEndian(bytesOf(coded), 2) == kZpng)
        decodeZpng(coded, image);
    else
        throw Error("a field is coded in an unknown way, neither as PNG nor as ZPNG");
    return image;
}
}  // namespace delio::io
