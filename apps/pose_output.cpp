#include "pose_output.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/doubts.h"

namespace delio {
namespace {
/** One object, without a line feed. */
std::string jsonOf(const run::Run::Pose& now, const run::RunRow& row,
                   const std::optional<double>& latency_ms) {
    const Eigen::Vector3d at = now.pose.translation();
    Eigen::Quaterniond q(now.pose.linear());
    if (q.w() < 0) q.coeffs() *= -1;
    const auto list = [](std::initializer_list<double> numbers) {
        std::string text;
        for (const double number : numbers) text += (text.empty() ? "[" : ",") + digitsOf(number);
        return text + "]";
    };
    return "{\"scan\":" + std::to_string(row.scan) + ",\"stamp_s\":" + digitsOf(now.stamp_s) +
           ",\"frame\":\"" + (now.isInMap ? "map" : "start") +
           "\",\"position_m\":" + list({at.x(), at.y(), at.z()}) +
           ",\"quaternion_xyzw\":" + list({q.x(), q.y(), q.z(), q.w()}) + ",\"state\":\"" +
           run::stateOf(row) + "\"" +
           (latency_ms ? ",\"latency_ms\":" + fixed(*latency_ms, 2) : "") + "}";
}
}  // namespace

PoseOutput::PoseOutput(const std::string& format, const std::string& target) : format_(format) {
    if (!format_.empty()) {
        // A reader that ends does not end the drive, and one that waits does not delay warnings.
        std::signal(SIGPIPE, SIG_IGN);
        std::cerr.tie(nullptr);
    }
    if (!target.empty()) connect(target);
}

PoseOutput::~PoseOutput() {
    if (socket_ >= 0) close(socket_);
}

void PoseOutput::connect(const std::string& target) {
    const std::string rest = io::isLive(target) ? target.substr(6) : "";
    const auto colon = rest.rfind(':');
    const auto port =
        colon == rest.npos ? std::vector<double>() : cli::numbersIn(rest.substr(colon + 1), 1);
    if (colon == 0 || port.empty() || !(port[0] >= 1 && port[0] <= 65535))
        throw Error("'" + target + "' is not udp://HOST:PORT with a port up to 65535");
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int fault =
        getaddrinfo(rest.substr(0, colon).c_str(), rest.substr(colon + 1).c_str(), &wanted, &found);
    if (fault != 0)
        throw Error("cannot publish to '" + target + "': " + std::string(gai_strerror(fault)));
    for (const auto* at = found; at && socket_ < 0; at = at->ai_next) {
        socket_ = socket(at->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
        if (socket_ < 0 || ::connect(socket_, at->ai_addr, at->ai_addrlen) == 0) continue;
        close(socket_);
        socket_ = -1;
    }
    freeaddrinfo(found);
    if (socket_ < 0) throw Error("cannot publish to '" + target + "': no way to this address");
}

void PoseOutput::print(const std::string& line) {
    if (!hasReader_) return;
    errno = 0;
    std::cout << line << std::flush;
    if (std::cout) return;
    hasReader_ = false;
    const std::string cause =
        errno == EPIPE ? "nobody reads the poses on stdout"
                       : std::string("cannot write the poses to stdout: ") + std::strerror(errno);
    cli::warn(cause + "; the drive goes on");
}

void PoseOutput::add(const run::Run& run, const run::RunRow& row,
                     const run::Playback::Progress& progress) {
    if (format_.empty() && socket_ < 0) return;
    const auto now = run.latestPose();
    // One file has one frame: in a stored map the poses begin where the drive is found there.
    if (format_ == "tum" && (now.isInMap || run.record().storedMap.empty()))
        print(io::tumRow(now.stamp_s, now.pose));
    if (format_ != "json" && socket_ < 0) return;
    const std::string line = jsonOf(now, row, progress.latency_ms) + "\n";
    if (format_ == "json") print(line);
    // Where nobody listens, that is no fault.
    if (socket_ >= 0 && send(socket_, line.data(), line.size(), MSG_NOSIGNAL) < 0) return;
}
}  // namespace delio
