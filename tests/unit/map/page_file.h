#pragma once
#include <cstring>
#include <string>
#include <vector>

#include "delio/map/page.h"

namespace delio::test {
/** What stands between <script ... id="ID"> and its end. */
inline std::string scriptOf(const std::string& page, const std::string& id) {
    const auto name = page.find("id=\"" + id + "\">\n");
    if (name == std::string::npos) return "";
    const auto begin = page.find('\n', name) + 1;
    return page.substr(begin, page.find("</script>", begin) - begin);
}

inline std::string fromBase64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0, held = 0;
    for (const char c : text) {
        const auto digit = digits.find(c);
        if (digit == std::string::npos) continue;  // line ends and padding
        bits = bits << 6 | static_cast<unsigned>(digit);
        held += 6;
        if (held < 8) continue;
        held -= 8;
        bytes += static_cast<char>(bits >> held & 0xff);
    }
    return bytes;
}

template <typename Number>
std::vector<Number> numbersOf(const std::string& page, const std::string& id) {
    const std::string bytes = fromBase64(scriptOf(page, id));
    std::vector<Number> numbers(bytes.size() / sizeof(Number));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
    return numbers;
}

/** A trajectory of `count` poses one metre apart, x forward. */
inline std::vector<Eigen::Isometry3d> straightWay(std::size_t count) {
    std::vector<Eigen::Isometry3d> poses(count, Eigen::Isometry3d::Identity());
    for (std::size_t i = 0; i < count; ++i) poses[i].translation().x() = static_cast<double>(i);
    return poses;
}
}  // namespace delio::test
