#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <unordered_map>
#include <vector>

namespace delio::synth {
/** Short pieces of a line, seen from above, sorted into cells, so that those near a place are found
 *  in a time that does not grow with the length of the line. */
class LineIndex {
 public:
    struct Segment {
        Eigen::Vector2d a, b;
        double s;          //!< metres along the line at `a`
        bool first, last;  //!< no other goes on before `a`, after `b`
    };
    struct Nearest {
        double distance;                   //!< `reach` where nothing is nearer
        const Segment* segment = nullptr;  //!< none within `reach`
        bool beyondEnd = false;            //!< the nearest is where a line begins or ends
    };

    void add(const Segment& segment);
    /** Of the segments with `s` below `before_s`. `reach`: up to 64 m cost little. */
    Nearest nearest(const Eigen::Vector2d& place, double reach,
                    double before_s = std::numeric_limits<double>::max()) const;
    /** Calls `use` with every segment in a cell that is nearer than `reach`. */
    void visit(const Eigen::Vector2d& place, double reach,
               const std::function<void(const Segment&)>& use) const;

 private:
    static constexpr double kCell_m = 16, kLongest_m = 2;
    using Cell = std::vector<Segment>;
    const Cell* cell(int column, int row) const;

    std::unordered_map<std::uint64_t, Cell> cells_;
};
}  // namespace delio::synth
