#include "ros2_folder.h"

#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "../names.h"
#include "delio/core/error.h"
#include "mcap_file.h"
#include "ros2_database.h"

namespace delio::io {
namespace fs = std::filesystem;

Ros2Folder::Ros2Folder(const std::string& folder) : folder_(folder) {
    path_ = (fs::path(folder) / "metadata.yaml").string();
    if (!fs::is_regular_file(path_)) throw Error("has no metadata.yaml");
    try {
        readMetadata(path_);
    } catch (const YAML::Exception& e) {
        throw Error("has a metadata.yaml that cannot be understood (" + e.msg + ")");
    }
    if (files_.empty()) throw Error("has a metadata.yaml that names no files");
    try {
        open();
    } catch (const Error& e) {
        throw Error("has '" + files_.front() + "', which " + e.what());
    }
    if (topics_.empty()) topics_ = source_->topics();
}

void Ros2Folder::readMetadata(const std::string& yaml) {
    const YAML::Node bag = YAML::LoadFile(yaml)["rosbag2_bagfile_information"];
    if (!bag || !bag.IsMap()) throw Error("has a metadata.yaml that does not describe a ROS 2 bag");
    const auto mode = bag["compression_mode"] ? bag["compression_mode"].as<std::string>() : "";
    if (!mode.empty() && mode != "NONE" && mode != "none")
        throw Error("is compressed: unpack it first (ros2 bag convert)");
    for (const auto& file : bag["relative_file_paths"]) {
        // Older bags have their own folder's name in it.
        const fs::path name = file.as<std::string>(), inside = fs::path(folder_) / name;
        const bool isThere = staysInside(name) && fs::exists(inside);
        files_.push_back((isThere ? inside : fs::path(folder_) / name.filename()).string());
    }
    for (const auto& topic : bag["topics_with_message_count"]) {
        const auto about = topic["topic_metadata"];
        addTopic(topics_, {about["name"].as<std::string>(), about["type"].as<std::string>(),
                           topic["message_count"].as<std::size_t>()});
    }
}

void Ros2Folder::open() {
    path_ = files_[done_];
    const std::string extension = fs::path(path_).extension().string();
    if (!fs::is_regular_file(path_)) throw Error("is not there, though metadata.yaml names it");
    if (extension == ".mcap")
        source_ = std::make_unique<McapFile>(path_);
    else
        source_ = std::make_unique<Ros2Database>(path_);
    if (only_) source_->only(*only_);
}

void Ros2Folder::only(const std::string& topic) {
    only_ = topic;
    source_->only(topic);
}

std::optional<Message> Ros2Folder::next() {
    while (true) {
        if (auto message = source_->next()) return message;
        if (done_ + 1 >= files_.size()) return std::nullopt;
        ++done_;
        open();
    }
}

double Ros2Folder::fraction() const {
    return (static_cast<double>(done_) + source_->fraction()) / static_cast<double>(files_.size());
}
}  // namespace delio::io
