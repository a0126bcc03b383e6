#pragma once
#include <cereal/archives/binary.hpp>
#include <cereal/types/chrono.hpp>
#include <cereal/types/common.hpp>
#include <cereal/types/deque.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>

#include <Eigen/Geometry>
#include <ostream>
#include <sstream>
#include <streambuf>
#include <string>
#include <utility>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/stage_options.h"

/** What a drive that is stopped is gone on with: the state of everything that scans have changed,
 *  to the bit. A class says in serialize(), cereal's convention, what has to be kept; what follows
 *  from options or from that is made again. */
namespace cereal {
template <class Archive, class Derived>
void save(Archive& archive, const Eigen::PlainObjectBase<Derived>& matrix) {
    if constexpr (Derived::SizeAtCompileTime == Eigen::Dynamic)
        archive(matrix.rows(), matrix.cols());
    archive(binary_data(
        matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(typename Derived::Scalar)));
}

template <class Archive, class Derived>
void load(Archive& archive, Eigen::PlainObjectBase<Derived>& matrix) {
    if constexpr (Derived::SizeAtCompileTime == Eigen::Dynamic) {
        Eigen::Index rows = 0, cols = 0;
        archive(rows, cols);
        matrix.resize(rows, cols);
    }
    archive(binary_data(
        matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(typename Derived::Scalar)));
}

template <class Archive, typename Scalar, int Dim, int Mode, int Options>
void serialize(Archive& archive, Eigen::Transform<Scalar, Dim, Mode, Options>& transform) {
    archive(transform.matrix());
}
}  // namespace cereal

namespace delio::checkpoint {
/** Of a part of a state. Only the same is read back: other options make other sizes and meanings.
 */
struct Label {
    std::string name;
    std::string options;  //!< that it was made with, as a text
};

/** The options' texts, for a label. */
std::string textOf(const std::vector<const StageOptions*>& stages);

/** A label, the format's number, and the bytes with their number and checksum. */
void writePart(std::ostream& out, const Label& label, const std::string& bytes);
/** The bytes. Error, and not much read, where there is no part of this label, whole and sound. */
std::string readPart(std::istream& in, const Label& label);
/** That a part which is sound does not fit to what it is read into. */
[[noreturn]] void misfit(const Label& label);

/** What a stream writes to as a string; std::ostringstream gives a copy only. */
class Bytes : public std::streambuf {
 public:
    const std::string& text() const { return text_; }
    std::string take() { return std::move(text_); }

 private:
    std::streamsize xsputn(const char* from, std::streamsize count) override {
        text_.append(from, static_cast<std::size_t>(count));
        return count;
    }
    int_type overflow(int_type next) override {
        if (next != traits_type::eof()) text_.push_back(traits_type::to_char_type(next));
        return traits_type::not_eof(next);
    }

    std::string text_;
};

template <class State>
void save(std::ostream& out, const Label& label, const State& state) {
    Bytes bytes;
    std::ostream stream(&bytes);
    cereal::BinaryOutputArchive archive(stream);
    archive(state);
    writePart(out, label, bytes.text());
}

/** Error as above; `state` is of no use then. */
template <class State>
void restore(std::istream& in, const Label& label, State& state) {
    std::istringstream bytes(readPart(in, label));
    try {
        cereal::BinaryInputArchive archive(bytes);
        archive(state);
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {  // cereal's, of what ends too early; of sizes
        misfit(label);
    }
    if (bytes.peek() != std::istringstream::traits_type::eof()) misfit(label);
}
}  // namespace delio::checkpoint
