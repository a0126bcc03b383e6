#pragma once
#include <mrpt/serialization/CArchive.h>

#include <string>

#include "gz_input.h"

namespace delio::io {
/** Reads MRPT objects from a rawlog. MRPT makes room for as many points as a cloud claims before it
 *  reads any: one turned bit asks for tens of GB. Here a cloud that claims more points than the
 *  rest of the file can hold (of a compressed file: 100 million) throws std::length_error. */
class RawlogArchive : public mrpt::serialization::CArchive {
 public:
    explicit RawlogArchive(GzInput& in) : in_(in) {}
    std::string getArchiveDescription() const override { return "rawlog"; }

 protected:
    std::size_t read(void* data, std::size_t count) override;
    std::size_t write(const void* data, std::size_t count) override {
        return in_.Write(data, count);
    }

 private:
    void checkPoints(const void* data) const;

    GzInput& in_;
    /** What the next read brings: MRPT writes a class's name, a byte of its version, and then, if
     *  it is a cloud, the count of its points. */
    enum class Next { Anything, Version, Points } next_ = Next::Anything;
};
}  // namespace delio::io
