#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace delio {
/** Values one after the other, as they lie in memory (little endian, as every machine that Debian's
 *  MRPT runs on). */
class ByteWriter {
 public:
    template <class Value>
    void put(const Value& value) {
        static_assert(std::is_arithmetic_v<Value>);
        append(&value, sizeof(Value));
    }
    template <class Value>
    void putAll(const Value* values, std::size_t count) {
        put<std::uint64_t>(count);
        append(values, count * sizeof(Value));
    }
    void put(const std::string& text) { putAll(text.data(), text.size()); }
    void put(const Eigen::Isometry3d& pose) {
        const Eigen::Matrix<double, 3, 4> rows = pose.matrix().topRows<3>();
        append(rows.data(), 12 * sizeof(double));
    }

    const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
    void append(const void* data, std::size_t count) {
        const auto* from = static_cast<const std::uint8_t*>(data);
        bytes_.insert(bytes_.end(), from, from + count);
    }
    std::vector<std::uint8_t> bytes_;
};

/** Reads values back; throws std::out_of_range at the end of the data, for numbers that are not
 *  finite, and for invalid poses. */
class ByteReader {
 public:
    explicit ByteReader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

    template <class Value>
    Value get() {
        Value value;
        take(&value, sizeof(Value));
        check(&value, 1);
        return value;
    }
    template <class Value>
    std::vector<Value> getAll() {
        const auto count = get<std::uint64_t>();
        if (count > (bytes_.size() - at_) / sizeof(Value)) throw std::out_of_range("count");
        std::vector<Value> values(count);
        take(values.data(), count * sizeof(Value));
        check(values.data(), count);
        return values;
    }
    std::string getText() {
        const auto text = getAll<char>();
        return {text.begin(), text.end()};
    }
    Eigen::Isometry3d getPose() {
        Eigen::Matrix<double, 3, 4> rows;
        take(rows.data(), 12 * sizeof(double));
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.matrix().topRows<3>() = rows;
        // Eigen's maxCoeff() may pass over a NaN.
        constexpr double kFarthest_m = 1e8, kOff = 1e-3;
        const Eigen::Matrix3d square = pose.linear() * pose.linear().transpose();
        if (!pose.matrix().allFinite() || pose.translation().cwiseAbs().maxCoeff() > kFarthest_m ||
            (square - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kOff)
            throw std::out_of_range("pose");
        return pose;
    }

    bool atEnd() const { return at_ == bytes_.size(); }

 private:
    template <class Value>
    static void check(const Value* values, std::size_t count) {
        if constexpr (std::is_floating_point_v<Value>)
            if (!std::all_of(values, values + count, [](Value v) { return std::isfinite(v); }))
                throw std::out_of_range("number");
    }
    void take(void* to, std::size_t count) {
        if (count > bytes_.size() - at_) throw std::out_of_range("bytes");
        if (count > 0) std::memcpy(to, bytes_.data() + at_, count);
        at_ += count;
    }
    const std::vector<std::uint8_t>& bytes_;
    std::size_t at_ = 0;
};

/** Points within 160 m of the origin, rounded to 5 mm, in the order of small cells, so that they
 *  pack well; those farther off are left out. */
void put(ByteWriter& bytes, const Eigen::Matrix3Xf& points);
Eigen::Matrix3Xf getPoints(ByteReader& bytes);
}  // namespace delio
