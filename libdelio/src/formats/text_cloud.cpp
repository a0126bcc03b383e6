#include "text_cloud.h"

#include <cstring>

#include "delio/core/error.h"
#include "files/input_file.h"
#include "number_line.h"

namespace delio::io {
namespace {
class TextScan {
 public:
    explicit TextScan(const std::filesystem::path& file) : file_(file) {}

    CloudRecords read() {
        const auto bytes = bytesOfFile(file_);
        std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        const std::string_view mark = "\xEF\xBB\xBF";  // of UTF-8
        if (rest.substr(0, mark.size()) == mark) rest.remove_prefix(mark.size());
        while (const auto line = nextLine(rest, &line_)) {
            if (line->front() == '#') continue;
            if (records_.layout.step == 0 && !begin(*line)) continue;
            if (count_ == 1) records_.bytes.reserve(rest.size() / line->size() * 9 / 8 * step());
            add(*line);
        }
        if (count_ == 0) throw Error("'" + file_.string() + "' contains no points");
        records_.count = count_;
        return std::move(records_);
    }

 private:
    std::size_t step() const { return records_.layout.step; }

    [[noreturn]] void refuse(const std::string& why) const {
        throw Error("'" + file_.string() + "', line " + std::to_string(line_) + ": " + why);
    }

    /** Takes the names of the columns from the first line, or their usual ones. False: the line is
     *  names. */
    bool begin(std::string_view line) {
        static const char* const kUsual[] = {"x", "y", "z", "intensity", "time", "ring"};
        const std::size_t found = numbersIn(line, values_);
        std::vector<std::string> names;
        if (found == kNoNumbers) {
            for (const auto word : wordsIn(line)) names.emplace_back(word);
        } else if (found < 3 || found > std::size(kUsual)) {
            refuse("a point has 3 to 6 numbers (x y z intensity time ring), not " +
                   std::to_string(found) + "; name the columns in the first line");
        } else {
            names.assign(kUsual, kUsual + found);
        }
        records_.layout = layoutOfDoubles(names);
        values_.resize(names.size());
        if (found == kNoNumbers) requirePlaces();
        return found != kNoNumbers;
    }

    void requirePlaces() const {
        for (const std::string name : {"x", "y", "z"}) {
            bool there = false;
            for (const auto& field : records_.layout.fields) there = there || field.name == name;
            if (!there) refuse("expected numbers, or a header with a column '" + name + "'");
        }
    }

    void add(std::string_view line) {
        const std::size_t found = numbersIn(line, values_);
        if (found == kNoNumbers) refuse("expected only numbers");
        if (found != values_.size())
            refuse("there are " + std::to_string(found) + " numbers, not " +
                   std::to_string(values_.size()));
        const auto* from = reinterpret_cast<const std::uint8_t*>(values_.data());
        records_.bytes.insert(records_.bytes.end(), from, from + step());
        ++count_;
    }

    std::filesystem::path file_;
    CloudRecords records_;
    std::size_t line_ = 0, count_ = 0;
    std::vector<double> values_;
};
}  // namespace

CloudRecords readTextScan(const std::filesystem::path& file) { return TextScan(file).read(); }
}  // namespace delio::io
