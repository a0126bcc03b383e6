#pragma once
#include <cstdint>
#include <vector>

#include "places/descriptor.h"

namespace delio::places {
/** A candidate: a place that a cloud may show. */
struct PlaceMatch {
    std::size_t place = 0;  //!< its number, in the order of add()
    Shift shift;  //!< the cloud to the place; not better than a cell of 2 m and 5 deg, z is 0
};

/** Global search over many places: a cloud is compared with all of them, at all headings and at
 *  shifts of up to 20 m. */
class PlaceIndex {
 public:
    /** The next place. */
    void add(const HeightImage& image);
    std::size_t size() const { return places_.size(); }  //!< places

    /** The best matches of each place at up to four headings, of all these the best `most`, the
     * best first. */
    std::vector<PlaceMatch> find(const HeightImage& cloud, std::size_t most) const;
    /** The same among some places only. */
    std::vector<PlaceMatch> find(const HeightImage& cloud, const std::vector<std::size_t>& places,
                                 std::size_t most) const;

 private:
    struct Cell {
        int x, y;
        std::uint8_t bands;
    };
    struct Turned;
    class Overlaps;
    static Raster rasterOf(const HeightImage& image, double yaw, int margin);
    static std::vector<Turned> turnsOf(const HeightImage& cloud);
    static std::vector<Shift> best(const Raster& place, const std::vector<Turned>& turns);

    std::vector<Raster> places_;
};
}  // namespace delio::places
