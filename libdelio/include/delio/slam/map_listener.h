#pragma once
#include "delio/map/map_builder.h"
#include "delio/slam/listener.h"

namespace delio {
/** Puts the points of a drive into a map, without those of dynamic objects. A scan that could not
 *  be registered is left out: where it was taken is a guess. The map's lengths follow the size of
 *  the place ("scale" among the step's details) at the first scan. */
class MapListener : public SlamListener {
 public:
    /** `builder`: empty. */
    explicit MapListener(map::MapBuilder builder) : builder_(std::move(builder)) {}

    const char* name() const override { return "map"; }
    void add(const SlamScan& scan) override;

    const map::MapBuilder& builder() const { return builder_; }  //!< with what was added so far

 private:
    map::MapBuilder builder_;
};
}  // namespace delio
