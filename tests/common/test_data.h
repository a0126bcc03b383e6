#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace delio::test {
/** Where the real data lies: DELIO_DATA, or ../shared/data beside the project. */
std::filesystem::path dataFolder();

/** share/config of the source tree. */
std::filesystem::path profileFolder();

/** Trajectories that may not change unnoticed: tests/real/frozen of the source tree. */
std::filesystem::path frozenFolder();

/** True if the data is there. Otherwise the caller skips, or fails under DELIO_REQUIRE_DATA=1. */
bool haveData(const std::string& part);
bool dataIsRequired();

/** A folder that is gone when the test is over. */
class TemporaryFolder {
 public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

void writeText(const std::filesystem::path& path, const std::string& text);
std::string readText(const std::filesystem::path& path);
}  // namespace delio::test

/** First line of a test that needs `part` of the real data, e.g. "kitti/00_first16". */
#define DELIO_NEED_DATA(part)                                                                   \
    if (!delio::test::haveData(part)) {                                                         \
        const std::string missing =                                                             \
            (delio::test::dataFolder() / (part)).string() + " is not there (set DELIO_DATA)";   \
        if (delio::test::dataIsRequired()) FAIL() << missing << " and DELIO_REQUIRE_DATA is 1"; \
        GTEST_SKIP() << missing;                                                                \
    }
