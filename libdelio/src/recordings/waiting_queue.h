#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace delio::io {
/** A bounded queue from one thread to another. */
template <typename Item>
class WaitingQueue {
 public:
    /** `most`: sum of the weights that wait at a time. */
    explicit WaitingQueue(std::size_t most) : most_(most) {}

    /** False where it is full or closed: the item is not added. */
    bool add(Item item, std::size_t weight = 1) {
        const std::lock_guard lock(mutex_);
        if (closed_ || held_ + weight > most_) return false;
        held_ += weight;
        items_.emplace_back(std::move(item), weight);
        changed_.notify_one();
        return true;
    }

    /** Waits for the next item; nothing where the queue is closed and empty. */
    std::optional<Item> take() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return closed_ || !items_.empty(); });
        if (items_.empty()) return {};
        auto [item, weight] = std::move(items_.front());
        items_.pop_front();
        held_ -= weight;
        return std::move(item);
    }

    /** Nothing is added from here on. */
    void close() {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        changed_.notify_all();
    }

    /** Closes it and removes what waits. */
    void discard() {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        items_.clear();
        held_ = 0;
        changed_.notify_all();
    }

 private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::pair<Item, std::size_t>> items_;
    std::size_t most_, held_ = 0;
    bool closed_ = false;
};
}  // namespace delio::io
