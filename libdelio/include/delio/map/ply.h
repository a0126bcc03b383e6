#pragma once
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <string>

#include "delio/map/colormap.h"

namespace delio::map {
/** Writes points as a binary little-endian PLY: float x y z (metres), float intensity (0 where the
 *  map has none), uchar red green blue (by height, between robust limits). MRPT, CloudCompare and
 *  MeshLab read it. The same points give the same bytes. Throws Error if the file cannot be
 *  written.
 *  (MRPT's own exporter writes colours as grey, and does not notice a full disk.) */
void savePly(const mrpt::maps::CPointsMap& points, const std::string& path,
             Colormap colormap = Colormap::Turbo);

/** Reads the vertices of a PLY, ascii or binary little-endian, with x, y, z of any type and, if
 *  it is there, intensity; other properties are skipped, points that are not finite are dropped.
 *  Throws Error for a file that is missing, no such PLY, or cut off. */
mrpt::maps::CPointsMapXYZI loadPly(const std::string& path);
}  // namespace delio::map
