#pragma once
#include "mesh.h"
#include "random.h"

namespace delio::synth {
// What stands and hangs in rooms. `frame`: the origin is on the floor. What stands at a wall has
// its origin at the foot of the wall, in the middle, x along the wall and y into the room; all else
// in its own middle.

/** Books and boxes on boards. */
void addShelf(Mesh& mesh, const Frame& frame, double length, Random& random);
constexpr double kShelfDepth_m = 0.36;
void addCabinet(Mesh& mesh, const Frame& frame, double length, Random& random);
constexpr double kCabinetDepth_m = 0.55;
void addSofa(Mesh& mesh, const Frame& frame, double length, Random& random);
constexpr double kSofaDepth_m = 0.85;
void addRadiator(Mesh& mesh, const Frame& frame, double length);
/** A board or a picture on the wall. */
void addBoard(Mesh& mesh, const Frame& frame, double length, Random& random);
/** A door that is shut, in its frame. */
void addShutDoor(Mesh& mesh, const Frame& frame, double length);
constexpr double kFlatDepth_m = 0.12;  //!< of radiators, boards and doors

/** With things on it and chairs around. */
void addTable(Mesh& mesh, const Frame& frame, double length, double width, Random& random);
constexpr double kChair_m = 0.55;  //!< beyond the table's edges
void addPillar(Mesh& mesh, const Frame& frame, double height, Random& random);
constexpr double kPillar_m = 0.5;  //!< the thickest
void addPlant(Mesh& mesh, const Frame& frame, Random& random);
/** Under a ceiling at `height`. */
void addLamp(Mesh& mesh, const Frame& frame, double height, Random& random);
}  // namespace delio::synth
