#pragma once
#include <cstddef>
#include <deque>
#include <iterator>

namespace delio::odometry {
/** Samples that wait for a scan as late as they are, by their stamps.
 *  @tparam Sample has a stamp_s */
template <typename Sample>
class WaitingSamples {
 public:
    bool isEmpty() const { return samples_.empty(); }

    /** Of 200 000 samples that wait, the earliest is dropped: false then. */
    bool add(const Sample& sample) {
        constexpr std::size_t kMost = 200'000;
        auto place = samples_.end();
        while (place != samples_.begin() && std::prev(place)->stamp_s > sample.stamp_s) --place;
        samples_.insert(place, sample);
        if (samples_.size() <= kMost) return true;
        samples_.pop_front();
        return false;
    }

    /** Gives `use` the samples whose stamps, less `shift_s`, are up to `end_s`; the earliest first.
     */
    template <typename Use>
    void takeUpTo(double end_s, double shift_s, const Use& use) {
        for (; !samples_.empty() && samples_.front().stamp_s - shift_s <= end_s;
             samples_.pop_front())
            use(samples_.front());
    }

 private:
    std::deque<Sample> samples_;
};
}  // namespace delio::odometry
