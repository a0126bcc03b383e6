#pragma once
#include <filesystem>
#include <vector>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** Reads scans that lie in a file each: what such readers share. */
class FilesReader : public ScanReader {
 public:
    std::optional<Scan> next() override;
    bool skip() override;
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return otherLabels_; }
    std::optional<double> fraction() const override;

 protected:
    explicit FilesReader(std::string label) : label_(std::move(label)) {}
    /** The files, in the order of the scans. */
    virtual const std::vector<std::filesystem::path>& files() const = 0;
    /** Points and times of the `index`-th scan. Throws Error, which names the file. */
    virtual Scan read(std::size_t index) = 0;

 private:
    std::string label_;
    std::set<std::string> otherLabels_;  // none
    std::size_t count_ = 0;
};
}  // namespace delio::io
