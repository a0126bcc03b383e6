#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "delio/core/error.h"
#include "findings.h"
#include "message_source.h"
#include "mrpt/clock.h"
#include "scan_maker.h"
#include "scan_parts.h"

namespace delio::io {
namespace {
/** A CustomMsg without its points. */
struct LivoxHead {
    double stamp_s = 0;
    std::uint64_t base_ns = 0;  //!< what the points' times count from
    unsigned lidar = 0;
};

LivoxHead readHead(WireReader& in, double log_s) {
    LivoxHead head;
    head.stamp_s = in.header().stamp_s;
    head.base_ns = in.number<std::uint64_t>();
    in.number<std::uint32_t>();  // the number of points, which the array repeats
    head.lidar = in.number<std::uint8_t>();
    in.bytes(3);
    if (head.stamp_s == 0) head.stamp_s = log_s;
    return head;
}

float floatOf(std::uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
}

/** Makes scans of a Livox's CustomMsg: points, intensities and times. Its lines are no rings: a
 *  beam of it has no elevation of its own. */
class LivoxMaker : public ScanMaker {
 public:
    void add(const Message& message, std::size_t scan) override;
    void finish() override { joiner_.finish(); }
    std::optional<Scan> take() override { return joiner_.take(); }
    std::string sensor() const override { return "Livox"; }
    std::vector<std::string> findings() const override { return findings_.lines(); }

 private:
    void addPoints(WireReader& in, Scan& part, std::size_t scan);
    double startOf(const LivoxHead& head);

    PatternJoiner joiner_;
    std::optional<unsigned> lidar_;  //!< of the first message
    std::uint64_t begun_ns_ = 0;     //!< base of the first message of the scan
    Findings findings_;
};

/** The sensor's own clock orders the messages of a scan, and the header when they
 *  came. */
double LivoxMaker::startOf(const LivoxHead& head) {
    constexpr double kApart_s = 0.05;
    const auto begun_s = joiner_.begun_s();
    if (!begun_s || head.base_ns <= begun_ns_) return head.stamp_s;
    const double start_s = *begun_s + 1e-9 * static_cast<double>(head.base_ns - begun_ns_);
    return std::abs(start_s - head.stamp_s) < kApart_s ? start_s : head.stamp_s;
}

void LivoxMaker::addPoints(WireReader& in, Scan& part, std::size_t scan) {
    constexpr std::size_t kPoint = 19;
    constexpr double kLongest_s = 1;
    const std::size_t count = in.length(kPoint);
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(count);
    part.times_s.resize(count);
    std::size_t impossible = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double time_s = 1e-9 * in.number<std::uint32_t>();
        const float x = floatOf(in.number<std::uint32_t>()),
                    y = floatOf(in.number<std::uint32_t>()),
                    z = floatOf(in.number<std::uint32_t>());
        points->setPointFast(i, x, y, z);
        points->setPointIntensity(i, static_cast<float>(in.number<std::uint8_t>()) / 255.0F);
        in.bytes(2);  // tag and line
        const bool isPossible = time_s < kLongest_s;
        impossible += !isPossible;
        part.times_s[i] =
            isPossible ? static_cast<float>(time_s) : std::numeric_limits<float>::quiet_NaN();
    }
    points->mark_as_modified();
    part.points = points;
    if (impossible > 0) findings_.add("points without a valid time: ignored", scan, impossible);
}

void LivoxMaker::add(const Message& message, std::size_t scan) {
    WireReader in(message);
    const LivoxHead head = readHead(in, message.log_s);
    if (!lidar_) lidar_ = head.lidar;
    if (head.lidar != *lidar_) {
        findings_.add("messages of another lidar_id than " + std::to_string(*lidar_) + ": ignored",
                      scan);
        return;
    }
    Scan part;
    part.stamp_s = startOf(head);
    part.time = timeOf(part.stamp_s);
    addPoints(in, part, scan);
    const auto before = joiner_.begun_s();
    joiner_.add(std::move(part));
    if (joiner_.begun_s() != before) begun_ns_ = head.base_ns;
}
}  // namespace

std::unique_ptr<ScanMaker> makeLivoxMaker() { return std::make_unique<LivoxMaker>(); }
}  // namespace delio::io
