#pragma once
#include <mrpt/img/CImage.h>
#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "test_data.h"

namespace delio::test {
bool isInstalled(const std::string& program);

/** An X server without a screen (Xvfb), which DISPLAY names while this lives, and the programs that
 *  were started on it, which end with it. */
class VirtualDisplay {
 public:
    VirtualDisplay();
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    /** HOME of the programs that are started. */
    const std::filesystem::path& home() const { return folder_.path(); }

    void start(const std::string& program, const std::vector<std::string>& arguments);

    /** Titles of the windows that can be seen. */
    std::vector<std::string> windows() const;

    /** Waits for a window whose title holds `text`; false if it does not come within a minute. */
    bool waitFor(const std::string& text) const;

    mrpt::img::CImage screenshot() const;

 private:
    pid_t run(const std::vector<std::string>& words, int output) const;

    TemporaryFolder folder_;  //!< the server's picture, and the home of the programs
    std::vector<pid_t> processes_;
};
}  // namespace delio::test

/** First lines of a test that needs these programs (and Xvfb, xwininfo). */
#define DELIO_NEED_PROGRAMS(...)                                                              \
    for (const std::string program : {"Xvfb", "xwininfo", __VA_ARGS__})                       \
        if (!delio::test::isInstalled(program)) {                                             \
            if (delio::test::dataIsRequired()) FAIL() << program << " is not installed";      \
            GTEST_SKIP() << program << " is not installed (share/scripts/dependencies test)"; \
        }
