#pragma once
#include "mesh.h"
#include "random.h"

namespace delio::synth {
// What grows and lies in a forest, besides bushes and grass (vegetation.h). `frame`: the origin is
// on the ground, in the middle.

struct ForestTree {
    double diameter_m;    //!< of the trunk, at the height of a breast
    double lowReach_m;    //!< of branches below kFree_m: beyond, somebody drives
    bool conifer, dense;  //!< from afar fewer leaves do
};
/** A trunk that leans a little, dead and living branches, leaves. */
void addForestTree(Mesh& mesh, const Frame& frame, const ForestTree& tree, Random& random);
constexpr double kFree_m = 3.5;

/** 1-3 m high, as thick as a thumb. */
void addSapling(Mesh& mesh, const Frame& frame, Random& random);
/** Fronds from one place, knee-high. */
void addFern(Mesh& mesh, const Frame& frame, Random& random);
void addStump(Mesh& mesh, const Frame& frame, Random& random);
/** A fallen trunk along the frame's x axis, up to kLog_m long. */
void addLog(Mesh& mesh, const Frame& frame, Random& random);
constexpr double kLog_m = 5;
}  // namespace delio::synth
