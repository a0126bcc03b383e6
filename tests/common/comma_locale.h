#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <locale>
#include <string>

#include "test_data.h"

namespace delio::test {
/** While it lives, the program has the German locale: C's and C++'s decimal point is a comma, and
 *  streams group digits. The locale is made for the test: few machines have it. */
class CommaLocale {
 public:
    CommaLocale() : before_(std::locale()) {
        const std::string made = folder_ / "de_DE.UTF-8";
        const std::string make = "localedef -i de_DE -f UTF-8 '" + made + "' >/dev/null 2>&1";
        const int code = std::system(make.c_str());
        EXPECT_TRUE(code == 0 || code == 1 << 8) << make;  // exit code 1 is a warning
        setenv("LOCPATH", folder_.path().c_str(), 1);
        std::locale::global(std::locale("de_DE.UTF-8"));
    }
    ~CommaLocale() {
        std::locale::global(before_);
        unsetenv("LOCPATH");
    }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;

 private:
    TemporaryFolder folder_;
    std::locale before_;
};
}  // namespace delio::test
