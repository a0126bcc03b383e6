#include "ouster_json.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "../side_file.h"
#include "delio/core/error.h"
#include "ouster_frame.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
bool fits(const SideFile& json, const std::uint8_t* packet, std::size_t bytes) {
    try {
        const OusterInfo info = readOusterInfo(json.text, json.name);
        return info.packetBytes() == bytes && info.ids.fit(OusterPacket(info, packet).ids());
    } catch (const Error&) {
        return false;
    }
}

/** Those that name beams, by name. */
std::vector<SideFile> descriptionsIn(const fs::path& folder) {
    constexpr std::uintmax_t kMostBytes = 1 << 20;
    std::vector<SideFile> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        if (entry.path().extension() != ".json" || !entry.is_regular_file() ||
            entry.file_size() > kMostBytes)
            continue;
        SideFile json = sideFile(entry.path().string());
        if (json.text.find("beam_altitude_angles") != std::string::npos)
            found.push_back(std::move(json));
    }
    std::sort(found.begin(), found.end(),
              [](const SideFile& one, const SideFile& other) { return one.name < other.name; });
    return found;
}

void keepMostAlike(std::vector<SideFile>& jsons, const std::string& stem) {
    const auto likeness = [&](const SideFile& json) {
        return inCommon(fs::path(json.name).stem().string(), stem);
    };
    std::size_t most = 0;
    for (const SideFile& json : jsons) most = std::max(most, likeness(json));
    jsons.erase(std::remove_if(jsons.begin(), jsons.end(),
                               [&](const SideFile& json) { return likeness(json) < most; }),
                jsons.end());
}

std::string listed(const std::vector<SideFile>& jsons) {
    constexpr std::size_t kMost = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(kMost, jsons.size()); ++i)
        text += (i > 0 ? ", '" : "'") + jsons[i].name + "'";
    return text + (jsons.size() > kMost ? ", ..." : "");
}
}  // namespace

std::size_t inCommon(const std::string& one, const std::string& other) {
    const auto differ = std::mismatch(one.begin(), one.end(), other.begin(), other.end());
    return static_cast<std::size_t>(differ.first - one.begin());
}

SideFile ousterJsonBeside(const std::string& recording, const std::uint8_t* packet,
                          std::size_t bytes) {
    fs::path file = recording;
    if (!file.has_filename()) file = file.parent_path();  // DRIVE/
    const std::string stem = file.stem().string();
    const fs::path own = fs::path(file).replace_extension(".json");
    if (fs::is_regular_file(own)) return sideFile(own.string());
    const auto all = descriptionsIn(file.has_parent_path() ? file.parent_path() : ".");
    auto fitting = all;
    if (packet)
        fitting.erase(
            std::remove_if(fitting.begin(), fitting.end(),
                           [&](const SideFile& json) { return !fits(json, packet, bytes); }),
            fitting.end());
    // Where none fits, the likeliest one says in what it does not.
    if (fitting.empty()) fitting = all;
    keepMostAlike(fitting, stem);
    if (fitting.size() == 1) return fitting.front();
    throw Error("holds an Ouster's packets, but their description '" + own.string() +
                "' is not there" +
                (fitting.empty() ? "" : ", and several others may be it: " + listed(fitting)) +
                "; name it with --sensor-info");
}
}  // namespace delio::io
