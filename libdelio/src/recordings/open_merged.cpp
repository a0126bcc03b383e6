#include "open_merged.h"

#include <algorithm>
#include <utility>

#include "delio/core/error.h"
#include "merged_reader.h"
#include "sources.h"

namespace delio::io {
namespace {
constexpr const char* kAll = "all";

/** Of a bag, by name; otherwise those that send in the first seconds, in that order. */
std::vector<std::string> sensorsOf(ScanSource source, const OpenSensor& open) {
    if (source.path == "-") throw Error("--sensor-label all needs a file, not standard input");
    if (auto topics = scanTopicsOf(source.path); !topics.empty()) return topics;
    constexpr int kScans = 50;
    source.label.clear();
    const auto reader = open(source);
    for (int scan = 0; scan < kScans && reader->skip(); ++scan) continue;
    if (reader->otherLabels().empty()) return {""};
    std::vector<std::string> labels = {reader->label()};
    labels.insert(labels.end(), reader->otherLabels().begin(), reader->otherLabels().end());
    return labels;
}
}  // namespace

std::vector<std::string> labelsOf(const ScanSource& source, const OpenSensor& open) {
    if (isLive(source.path)) return {source.label};
    if (source.label == kAll) return sensorsOf(source, open);
    std::vector<std::string> labels;
    std::size_t begin = 0;
    while (begin != std::string::npos) {
        const auto comma = source.label.find(',', begin);
        labels.push_back(source.label.substr(begin, comma - begin));
        begin = comma == std::string::npos ? comma : comma + 1;
        if (std::count(labels.begin(), labels.end(), labels.back()) > 1)
            throw Error("the sensor '" + labels.back() + "' is chosen twice: --sensor-label " +
                        source.label);
    }
    if (labels.size() > 1 && std::count(labels.begin(), labels.end(), "") > 0)
        throw Error("a name is missing between commas: --sensor-label " + source.label);
    return labels;
}

std::unique_ptr<ScanReader> openMerged(const ScanSource& source,
                                       const std::vector<std::string>& labels,
                                       const OpenSensor& open) {
    if (source.path == "-" && labels.size() > 1)
        throw Error("several sensors are merged from a file only, not from standard input");
    if (isLive(source.path)) throw Error("--extrinsics needs a recording, not a live sensor");
    ExtrinsicsFile extrinsics;
    if (!source.extrinsicsFile.empty()) extrinsics = readExtrinsics(source.extrinsicsFile);
    if (!source.extrinsics.empty()) extrinsics.lidars = source.extrinsics;
    std::vector<MergedSensor> sensors;
    for (const auto& label : labels) {
        ScanSource one = source;
        one.label = label;
        sensors.push_back({label, open(one)});
    }
    try {
        return std::make_unique<MergedReader>(std::move(sensors), extrinsics);
    } catch (const Error& e) {
        throw Error("'" + source.path + "': " + e.what());
    }
}
}  // namespace delio::io
