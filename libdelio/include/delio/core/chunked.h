#pragma once
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace delio {
/** A vector that grows without moving what it holds: no scan waits until a map of hundreds of
 *  megabytes is copied, and there never are two of them. */
template <typename Value>
class Chunked {
 public:
    Chunked() = default;
    /** Takes the values; the other one is empty then. */
    Chunked(Chunked&& other) noexcept
        : chunks_(std::move(other.chunks_)), size_(std::exchange(other.size_, 0)) {}
    /** The values of the other one. */
    Chunked& operator=(Chunked other) noexcept {
        std::swap(chunks_, other.chunks_);
        std::swap(size_, other.size_);
        return *this;
    }
    /** Copies every value. */
    Chunked(const Chunked& other) {
        for (std::size_t i = 0; i < other.size(); ++i) push_back(other[i]);
    }

    std::size_t size() const { return size_; }  //!< values
    /** The value with this number. */
    Value& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
    /** The value with this number. */
    const Value& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }

    /** What new values are is not said. */
    void resize(std::size_t size) {
        const std::size_t chunks = (size + kChunk - 1) / kChunk;
        while (chunks_.size() < chunks) chunks_.emplace_back(new Value[kChunk]);
        chunks_.resize(chunks);
        size_ = size;
    }
    /** One more. */
    void push_back(Value value) {
        resize(size_ + 1);
        (*this)[size_ - 1] = std::move(value);
    }

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        std::size_t size = size_;
        archive(size);
        resize(size);
        for (std::size_t i = 0; i < size_; ++i) archive((*this)[i]);
    }

 private:
    static constexpr std::size_t kChunk = 1024;
    std::vector<std::unique_ptr<Value[]>> chunks_;
    std::size_t size_ = 0;
};
}  // namespace delio
