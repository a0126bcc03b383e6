#include "names.h"

#include <algorithm>

namespace delio::io {
namespace {
constexpr std::string_view kDigits = "0123456789";

/** Takes the number that `text` begins with off it, without leading zeros; empty: none or 0. */
std::string_view takeNumber(std::string_view& text) {
    auto number = text.substr(0, text.find_first_not_of(kDigits));
    text.remove_prefix(number.size());
    number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
    return number;
}

bool beginsWithDigit(std::string_view text) {
    return !text.empty() && kDigits.find(text.front()) != kDigits.npos;
}
}  // namespace

bool naturallyBefore(std::string_view a, std::string_view b) {
    auto restA = a, restB = b;
    while (!restA.empty() && !restB.empty()) {
        if (beginsWithDigit(restA) && beginsWithDigit(restB)) {
            const auto numberA = takeNumber(restA), numberB = takeNumber(restB);
            if (numberA.size() != numberB.size()) return numberA.size() < numberB.size();
            if (numberA != numberB) return numberA < numberB;
            continue;
        }
        if (restA.front() != restB.front()) return restA.front() < restB.front();
        restA.remove_prefix(1);
        restB.remove_prefix(1);
    }
    if (restA.empty() != restB.empty()) return restA.empty();
    return a < b;
}

bool isFileName(const std::string& name) {
    return !name.empty() && name != "." && name != ".." &&
           std::none_of(name.begin(), name.end(),
                        [](const unsigned char c) { return c == '/' || c < 0x20 || c == 0x7F; });
}

bool staysInside(const std::filesystem::path& name) {
    return !name.is_absolute() && std::find(name.begin(), name.end(), "..") == name.end();
}
}  // namespace delio::io
