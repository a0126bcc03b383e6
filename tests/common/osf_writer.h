#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "recordings/ouster.h"

namespace delio::test {
/** A table of a FlatBuffer to be written: fields by their numbers. */
struct FlatTree {
    struct Field {
        std::size_t number;
        std::string scalar;            //!< its bytes, in the table
        std::size_t count = 0;         //!< of the records in `vector`
        std::string vector;            //!< bytes behind their count
        std::vector<FlatTree> tables;  //!< a vector of tables
        enum class Kind { kScalar, kVector, kTables } kind = Kind::kScalar;
    };
    std::vector<Field> fields;

    template <typename Number>
    FlatTree& number(std::size_t field, Number value) {
        fields.push_back({field,
                          std::string(reinterpret_cast<const char*>(&value), sizeof(value)),
                          0,
                          {},
                          {},
                          Field::Kind::kScalar});
        return *this;
    }
    template <typename Number>
    FlatTree& numbers(std::size_t field, const std::vector<Number>& values) {
        fields.push_back({field,
                          {},
                          values.size(),
                          std::string(reinterpret_cast<const char*>(values.data()),
                                      values.size() * sizeof(Number)),
                          {},
                          Field::Kind::kVector});
        return *this;
    }
    FlatTree& bytes(std::size_t field, const std::string& text) {
        fields.push_back({field, {}, text.size(), text, {}, Field::Kind::kVector});
        return *this;
    }
    FlatTree& tables(std::size_t field, std::vector<FlatTree> children) {
        fields.push_back({field, {}, 0, {}, std::move(children), Field::Kind::kTables});
        return *this;
    }
};

/** A FlatBuffer with this root, behind its size. */
std::string flatBuffer(const FlatTree& root);

enum class FieldCoding { kPng, kZpng };

/** Numbers of `bytes` bytes, row by row, as a PNG whose rows take turns in its filters, or as a
 *  ZPNG. */
std::string codedField(FieldCoding coding, std::size_t rows, std::size_t columns, std::size_t bytes,
                       const std::vector<std::uint32_t>& pixels);

/** A turn as Ouster's recorder writes it. `received_ns`: Unix time of its first packet. */
FlatTree osfTurn(const io::OusterInfo& info, const io::OusterFrame& frame, FieldCoding coding,
                 std::uint64_t received_ns);

/** A sensor's turns. */
struct OsfSensor {
    std::string json;
    std::vector<FlatTree> turns;
};
/** An OSF file of the sensors' turns, a chunk each. */
std::string osfFile(const std::vector<OsfSensor>& sensors);
}  // namespace delio::test
