#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace delio {
/** Gives back what largeMemory() gave. */
struct FreeMemory {
    void operator()(void* memory) const { std::free(memory); }  //!< free()
};
/** Allocates uninitialised bytes; throws std::bad_alloc if out of memory. Large blocks use 2 MB
 *  pages if available: random access to a table otherwise costs a second memory access for most of
 *  them where pages have 4 kB, and an interrupt for each page that it grows by. */
std::unique_ptr<void, FreeMemory> largeMemory(std::size_t bytes);

/** The same for containers. */
template <typename Value>
struct LargeAllocator {
    using value_type = Value;  //!< what there is room for
    LargeAllocator() = default;
    /** They all are the same. */
    template <typename Other>
    LargeAllocator(const LargeAllocator<Other>&) {}
    /** See largeMemory(). */
    Value* allocate(std::size_t values) {
        return static_cast<Value*>(largeMemory(values * sizeof(Value)).release());
    }
    /** Memory from allocate(). */
    void deallocate(Value* memory, std::size_t) { FreeMemory()(memory); }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }   //!< all
    friend bool operator!=(const LargeAllocator&, const LargeAllocator&) { return false; }  //!< no
};

/** Vector that grows without moving its elements: no scan waits for the copy of a map of hundreds
 *  of megabytes, and there are never two copies. Each chunk is as large as all earlier ones
 *  together. */
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
    ~Chunked() { resize(0); }

    std::size_t size() const { return size_; }  //!< values
    /** The value with this number. */
    Value& operator[](std::size_t i) { return *placeOf(i); }
    /** The value with this number. */
    const Value& operator[](std::size_t i) const { return *placeOf(i); }

    /** New values are default-constructed. Memory is never released. */
    void resize(std::size_t size) {
        while (size_ > size) std::destroy_at(placeOf(--size_));
        for (; size_ < size; ++size_) {
            if (size_ + kFirst == kFirst << chunks_.size())
                chunks_.push_back(largeMemory((kFirst << chunks_.size()) * sizeof(Value)));
            new (placeOf(size_)) Value;
        }
    }
    /** One more. */
    void push_back(Value value) {
        resize(size_ + 1);
        (*this)[size_ - 1] = std::move(value);
    }

 private:
    /** Chunk c has 2^c times as many values as the first one: where a value is follows from the
     *  highest bit of its number and the first chunk's values together. */
    Value* placeOf(std::size_t i) const {
        const std::size_t number = i + kFirst;
        const auto bit = static_cast<unsigned>(63 - __builtin_clzll(number));
        return static_cast<Value*>(chunks_[bit - kFirstBit].get()) +
               (number ^ (std::size_t{1} << bit));
    }

    static constexpr unsigned kFirstBit = 10;
    static constexpr std::size_t kFirst = std::size_t{1} << kFirstBit;
    std::vector<std::unique_ptr<void, FreeMemory>> chunks_;
    std::size_t size_ = 0;
};
}  // namespace delio
