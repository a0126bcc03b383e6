#pragma once
#include <string>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** Writes points as a binary little-endian PLY: float x y z (metres), nx ny nz, intensity, time
 *  (seconds), residual (metres), ushort observations, uchar red green blue. MRPT, CloudCompare and
 *  MeshLab read it. The same points give the same bytes. Throws Error if the file cannot be
 *  written, or the points do not have what they are to be coloured by.
 *  (MRPT's own exporter writes colours as grey, and does not notice a full disk.) */
void savePly(const MapPoints& points, const std::string& path, const Colouring& colouring = {});

/** Reads the vertices of a PLY, ascii or binary little-endian: x, y and z of any type, and whatever
 *  of nx ny nz, intensity, time, residual and observations is there; other properties are skipped,
 *  points that are not finite are dropped. Throws Error for a file that is missing, no such PLY, or
 *  cut off. */
MapPoints loadPly(const std::string& path);
}  // namespace delio::map
