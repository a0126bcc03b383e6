#pragma once
#include <mrpt/img/TColor.h>

#include <fstream>
#include <string>
#include <vector>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** What PLY and PCD share: a point is a record of numbers, each with a name. */
struct Column {
    std::string name;       //!< one that a map has no use for is skipped
    char kind = 'F';        //!< 'F' floating, 'I' and 'U' whole, with and without a sign
    std::size_t bytes = 4;  //!< F: 4 or 8; I and U: 1, 2, 4 or 8
};

/** True where there is such a number. */
bool isNumber(char kind, std::size_t bytes);

/** The columns of a point that are written, in their order: floats, then observations. Colours
 *  come after them, each kind of file having its own. The names are PLY's or, with `pcd`, PCD's;
 *  either are understood in both. */
std::vector<Column> writtenColumns(bool pcd);

/** Writes `header` and then a record a point: the written columns and `colourBytes` that
 *  `packColour` fills. Throws Error if that fails. */
void writePoints(const std::string& path, const std::string& header, const MapPoints& points,
                 const Colours& colours, std::size_t colourBytes,
                 void (*packColour)(const mrpt::img::TColor& colour, char* to));

/** A file of points that is read: its header first, by who knows its kind, then its records. */
class PointFile {
 public:
    /** @param kind names the kind in errors: "PLY". Throws Error where there is no such file. */
    PointFile(const std::string& path, std::string kind);

    /** The header's next line; false at the end. */
    bool line(std::string& text) { return static_cast<bool>(std::getline(in_, text)); }

    /** All points, from where the header ends; those that are not finite are dropped. Throws Error
     *  where x, y or z is missing, or fewer than `count` are whole. */
    MapPoints points(const std::vector<Column>& columns, std::size_t count, bool ascii);

    /** Throws an Error that names the file. */
    [[noreturn]] void refuse(const std::string& why) const;

 private:
    std::size_t bytesLeft();
    [[noreturn]] void refuseCut(std::size_t done, std::size_t count) const;

    std::string path_, kind_;
    std::ifstream in_;
};
}  // namespace delio::map
