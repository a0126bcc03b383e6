#pragma once
#include <netinet/in.h>

#include <optional>
#include <string>

#include "delio/run/playback.h"
#include "delio/run/run.h"

namespace delio {
/** Gives poses away as they come: on stdout, and as datagrams. */
class PoseOutput {
 public:
    /** `format`: "tum" or "json" for lines on stdout, empty for none. `target`: "udp://HOST:PORT",
     *  which gets a JSON line as a datagram for each pose; empty: none. Throws Error where the
     *  target is not known. */
    PoseOutput(const std::string& format, const std::string& target);
    ~PoseOutput();
    PoseOutput(const PoseOutput&) = delete;
    PoseOutput& operator=(const PoseOutput&) = delete;

    /** The pose of the scan that `run` processed last. */
    void add(const run::Run& run, const run::RunRow& row, const run::Playback::Progress& progress);

 private:
    void connect(const std::string& target);
    void print(const std::string& line);

    std::string format_;
    int socket_ = -1;
    bool hasReader_ = true;
};
}  // namespace delio
