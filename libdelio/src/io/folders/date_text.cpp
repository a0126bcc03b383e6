#include "date_text.h"

#include <cstdio>
#include <ctime>

#include "delio/core/numbers.h"

namespace delio::io {
std::optional<double> unixTimeOfDate(const std::string& text) {
    std::tm date{};
    char fraction[16] = "0";
    if (std::sscanf(text.c_str(), "%d-%d-%d %d:%d:%d.%15[0-9]", &date.tm_year, &date.tm_mon,
                    &date.tm_mday, &date.tm_hour, &date.tm_min, &date.tm_sec, fraction) < 6)
        return {};
    date.tm_year -= 1900;
    date.tm_mon -= 1;
    return static_cast<double>(timegm(&date)) + *numberIn<double>(std::string("0.") + fraction);
}
}  // namespace delio::io
