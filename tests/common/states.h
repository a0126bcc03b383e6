#pragma once
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

#include "core/checkpoint.h"
#include "delio/odometry/step.h"

/** What the tests of states that are stored share. */
namespace delio::test {
/** All that a step says, but for times and features. */
inline std::string bytesOf(Step step) {
    for (auto& time : step.times_ms) time.second = 0;
    std::ostringstream bytes;
    cereal::BinaryOutputArchive archive(bytes);
    archive(step);
    return bytes.str();
}

template <class Thing>
std::string stateOf(const Thing& thing) {
    std::ostringstream out;
    thing.save(out);
    return out.str();
}

template <class Thing>
void restore(Thing& thing, const std::string& state) {
    std::istringstream in(state);
    thing.restore(in);
    EXPECT_EQ(in.peek(), std::istringstream::traits_type::eof()) << "not all was read";
}

/** What an Error says of it; empty: it was taken. */
template <class Thing>
std::string refusalOf(Thing&& thing, const std::string& state) {
    std::istringstream in(state);
    try {
        thing.restore(in);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

/** Cut off anywhere, and with any byte changed, a state is refused with an Error, in one line.
 *  `make`: something to restore it into. */
template <class Make>
void expectOnlyWholeStates(const Make& make, const std::string& state) {
    const std::size_t stride = state.size() / 40 + 1;
    for (std::size_t at = 0; at < state.size(); at += at < 64 ? 3 : stride) {
        const auto cut = refusalOf(*make(), state.substr(0, at));
        EXPECT_NE(cut.find("the stored state of the drive"), std::string::npos) << at << cut;
        EXPECT_EQ(cut.find('\n'), std::string::npos) << cut;
        std::string changed = state;
        changed[at] = static_cast<char>(changed[at] ^ 0x40);
        EXPECT_NE(refusalOf(*make(), changed), "") << at;
    }
}
}  // namespace delio::test
