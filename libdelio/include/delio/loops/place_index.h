#pragma once
#include <cstdint>
#include <vector>

#include "delio/loops/height_image.h"

namespace delio::loops {
/** A place that a cloud may have been seen at. */
struct Sighting {
    std::size_t place = 0;  //!< its number, in the order of add()
    Shift shift;  //!< the cloud to the place; not better than a cell of 2 m and 5 deg, z is 0
};

/** Many places, to find the one that a cloud shows without knowing anything: all are compared, all
 *  headings, as far as 20 m from the middle of the place. */
class PlaceIndex {
 public:
    /** The next place. */
    void add(const HeightImage& image);
    std::size_t size() const { return places_.size(); }  //!< places

    /** Of each place that which fits best, of these the best `most`, the best first. */
    std::vector<Sighting> find(const HeightImage& cloud, std::size_t most) const;
    /** The same among some places only. */
    std::vector<Sighting> find(const HeightImage& cloud, const std::vector<std::size_t>& places,
                               std::size_t most) const;

 private:
    /** An image in large cells, as they lie. */
    struct Raster {
        int x0 = 0, y0 = 0, width = 0, height = 0;
        std::vector<std::uint8_t> bands;

        std::size_t at(int x, int y) const {
            return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x);
        }
    };
    struct Cell {
        int x, y;
        std::uint8_t bands;
    };
    struct Turned;
    class Overlaps;
    static Raster rasterOf(const HeightImage& image, double yaw, int margin);
    static std::vector<Turned> turnsOf(const HeightImage& cloud);
    static Sighting best(const Raster& place, const std::vector<Turned>& turns);

    std::vector<Raster> places_;
};
}  // namespace delio::loops
