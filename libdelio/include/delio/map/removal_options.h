#pragma once
#include "delio/core/stage_options.h"

namespace delio::map {
/** How dynamic objects are taken out of a map once the drive is over. */
struct RemovalOptions : StageOptions {
    bool enabled = true;
    double voxelSize_m = 0.2;
    double cell_deg = 0.4;
    double margin_m = 0.5;
    double spacing_m = 0.5;
    unsigned witnesses = 2;
    double freePerTaken = 1.5;
    double grownShare = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};
}  // namespace delio::map
