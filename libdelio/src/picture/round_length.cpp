#include "round_length.h"

#include <cmath>

#include "delio/core/numbers.h"

namespace delio::picture {
double roundLength(double length_m) {
    const double power = std::pow(10, std::floor(std::log10(length_m)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (length_m <= factor * power * 1.3) return factor * power;
    return 10 * power;
}

std::string metresText(double length_m) {
    return length_m >= 1000 ? rounded(length_m / 1000, 6) + " km" : rounded(length_m, 6) + " m";
}
}  // namespace delio::picture
