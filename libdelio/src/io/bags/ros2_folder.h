#pragma once
#include "message_source.h"

namespace delio::io {
/** Reads the folder of a ROS 2 bag: the .db3 or .mcap files that its metadata.yaml names, one after
 *  the other. */
class Ros2Folder : public MessageSource {
 public:
    /** Throws Error where metadata.yaml is missing or cannot be understood, names no files, or
     *  says that they are compressed, and as the first file's source. */
    explicit Ros2Folder(const std::string& folder);

    const std::vector<Topic>& topics() const override { return topics_; }
    void only(const std::string& topic) override;
    std::optional<Message> next() override;
    double fraction() const override;
    const std::string& path() const override { return path_; }

 private:
    void readMetadata(const std::string& yaml);
    void open();

    std::string folder_, path_;
    std::vector<std::string> files_;
    std::vector<Topic> topics_;
    std::optional<std::string> only_;
    std::unique_ptr<MessageSource> source_;
    std::size_t done_ = 0;
};
}  // namespace delio::io
