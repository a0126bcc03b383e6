#include "pcd_header.h"

#include <sstream>

#include "delio/core/numbers.h"

namespace delio::io {
PcdHeader readPcdHeader(RecordFile& file) {
    PcdHeader header;
    std::string line;
    for (unsigned row = 0; row < 1000 && file.line(line); ++row) {
        std::istringstream words(line);
        std::string keyword, word;
        if (!(words >> keyword) || keyword[0] == '#') continue;
        std::vector<std::string> rest;
        while (words >> word) rest.push_back(word);
        const auto number = numberIn<std::size_t>(rest.empty() ? "" : rest[0]);
        const bool isCount = keyword == "WIDTH" || keyword == "HEIGHT" || keyword == "POINTS";
        if (isCount && !number) file.refuse("its " + keyword + " is no count of points");
        if (keyword == "FIELDS" || keyword == "COLUMNS")
            header.names = rest;
        else if (keyword == "SIZE")
            header.sizes = rest;
        else if (keyword == "TYPE")
            header.types = rest;
        else if (keyword == "COUNT")
            header.counts = rest;
        else if (keyword == "WIDTH")
            header.width = number;
        else if (keyword == "HEIGHT")
            header.height = number;
        else if (keyword == "POINTS")
            header.points = number;
        else if (keyword == "DATA" && !rest.empty()) {
            header.data = rest[0];
            if (!header.points && header.width && header.height)
                header.points = *header.width * *header.height;
            return header;
        } else if (keyword != "VERSION" && keyword != "VIEWPOINT")
            break;
    }
    file.refuse("it has no whole header");
}

std::vector<Column> columnsOf(const PcdHeader& header, const RecordFile& file) {
    const std::size_t fields = header.names.size();
    if (fields == 0 || header.sizes.size() != fields || header.types.size() != fields ||
        (!header.counts.empty() && header.counts.size() != fields))
        file.refuse("FIELDS, SIZE, TYPE and COUNT do not have as many words");
    std::vector<Column> columns;
    for (std::size_t i = 0; i < fields; ++i) {
        const auto bytes = numberIn<std::size_t>(header.sizes[i]);
        const auto count =
            numberIn<std::size_t>(header.counts.empty() ? std::string("1") : header.counts[i]);
        constexpr std::size_t kMost = 4096;  // PCL's descriptors have some hundreds
        if (!bytes || header.types[i].size() != 1 || !isNumber(header.types[i][0], *bytes) ||
            !count || *count > kMost)
            file.refuse("its field '" + header.names[i] + "' is of no known type");
        for (std::size_t k = 0; k < *count; ++k)
            columns.push_back({k == 0 ? header.names[i] : "", header.types[i][0], *bytes});
    }
    return columns;
}
}  // namespace delio::io
