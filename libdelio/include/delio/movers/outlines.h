#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace delio::movers {
/** As alike as two views of one thing from about the same side, by its size (metres). */
bool alike(const Eigen::Vector3f& a, const Eigen::Vector3f& b);

/** Where the objects of a scan are and how large: closely packed, as of most of them nothing else
 *  is asked. Metres, the map's frame. */
class Outlines {
 public:
    std::size_t size() const { return places_[0].size(); }  //!< objects

    /** One more: its place's x is no less than that of the one before. */
    void add(const Eigen::Vector3f& place, const Eigen::Vector3f& size);

    /** An object's place. */
    Eigen::Vector3f place(std::size_t number) const {
        return {places_[0][number], places_[1][number], places_[2][number]};
    }
    /** An object's size. */
    Eigen::Vector3f sizeOf(std::size_t number) const {
        return {sizes_[0][number], sizes_[1][number], sizes_[2][number]};
    }
    /** The numbers from the first one to before the second one: of those whose places are within
     *  `reach` of `x` along the map's first axis. */
    std::pair<std::size_t, std::size_t> about(float x, float reach) const;

    /** Adds those of these numbers whose objects are alike in size. */
    void findAlike(const std::pair<std::size_t, std::size_t>& numbers, const Eigen::Vector3f& size,
                   std::vector<std::size_t>& found) const;

 private:
    std::array<std::vector<float>, 3> places_, sizes_;  //!< an axis each
};
}  // namespace delio::movers
