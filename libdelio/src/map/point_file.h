#pragma once
#include <mrpt/img/TColor.h>

#include <string>
#include <vector>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"
#include "formats/point_records.h"

namespace delio::map {
using io::Column;

/** The columns of a point that are written, in their order: floats, then observations. Colours
 *  come after them, each kind of file having its own. The names are PLY's or, with `pcd`, PCD's;
 *  either are understood in both. */
std::vector<Column> writtenColumns(bool pcd);

/** Writes `header` and then a record a point: the written columns and `colourBytes` that
 *  `packColour` fills. Throws Error if that fails. */
void writePoints(const std::string& path, const std::string& header, const MapPoints& points,
                 const Colours& colours, std::size_t colourBytes,
                 void (*packColour)(const mrpt::img::TColor& colour, char* to));

/** A file of points that is read: its header first, by the reader of its kind, then its records. */
class PointFile : public io::RecordFile {
 public:
    using RecordFile::RecordFile;

    /** All points, from where the header ends; those that are not finite are dropped. Throws Error
     *  where x, y or z is missing, or fewer than `count` are whole. */
    MapPoints points(const std::vector<Column>& columns, std::size_t count, bool ascii);
};
}  // namespace delio::map
