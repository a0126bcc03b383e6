#include "turn_assembler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "scan_parts.h"

namespace delio::io {
Sectors sectorsOf(const Scan& scan) {
    constexpr float kLeast_m = 0.1F;
    constexpr std::size_t kFewest = 3;  // points
    std::array<std::size_t, Sectors().size()> counts{};
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!(std::abs(x[i]) + std::abs(y[i]) > kLeast_m) || !std::isfinite(x[i] + y[i])) continue;
        const double turns = std::atan2(double{y[i]}, double{x[i]}) / (2 * M_PI) + 0.5;
        const auto sector = static_cast<std::size_t>(turns * static_cast<double>(counts.size()));
        ++counts[std::min(sector, counts.size() - 1)];
    }
    Sectors sectors;
    for (std::size_t i = 0; i < counts.size(); ++i) sectors[i] = counts[i] >= kFewest;
    return sectors;
}

namespace {
constexpr std::size_t kWhole = 60;  // sectors: no part of a turn has more

/** True where `next` covers other directions than `covered` does. Parts of a turn share one or two
 *  sectors where they meet. */
bool continues(const Sectors& covered, const Sectors& next) {
    constexpr double kShared = 0.25;
    return static_cast<double>((covered & next).count()) <=
           kShared * static_cast<double>(next.count());
}

/** True where most of the first scans cover other directions than the one before. */
bool holdParts(const std::deque<Scan>& scans) {
    constexpr std::size_t kFewest = 6, kLeast = 4;  // scans, sectors of a part
    constexpr double kMost = 0.7;                   // of the pairs: parts may be missing
    std::vector<Sectors> sectors;
    for (const auto& scan : scans)
        if (!scan.points->empty()) sectors.push_back(sectorsOf(scan));
    if (sectors.size() < kFewest) return false;
    std::size_t continued = 0;
    for (std::size_t i = 0; i < sectors.size(); ++i) {
        if (sectors[i].count() < kLeast || sectors[i].count() > kWhole) return false;
        continued +=
            i > 0 && continues(sectors[i - 1], sectors[i]) && continues(sectors[i], sectors[i - 1]);
    }
    return static_cast<double>(continued) >= kMost * static_cast<double>(sectors.size() - 1);
}

}  // namespace

TurnAssembler::TurnAssembler(std::unique_ptr<ScanReader> source) : source_(std::move(source)) {
    constexpr std::size_t kScans = 8;
    try {
        while (ahead_.size() < kScans) {
            auto scan = source_->next();
            if (!scan) break;
            ahead_.push_back(std::move(*scan));
            fractions_.push_back(source_->fraction());
            // One whole turn is enough to see that there are no parts.
            if (!ahead_.back().points->empty() && sectorsOf(ahead_.back()).count() > kWhole) break;
        }
    } catch (const std::exception&) {
        fault_ = std::current_exception();
    }
    areParts_ = holdParts(ahead_);
}

std::optional<Scan> TurnAssembler::nextPart() {
    if (!ahead_.empty()) {
        Scan scan = std::move(ahead_.front());
        ahead_.pop_front();
        fractions_.pop_front();
        return scan;
    }
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    return source_->next();
}

std::optional<Scan> TurnAssembler::next() {
    if (!areParts_) return nextPart();
    for (;;) {
        std::optional<Scan> part;
        try {
            part = nextPart();
        } catch (const std::exception&) {
            if (!begun_) throw;
            fault_ = std::current_exception();
        }
        if (!part) break;
        const Sectors sectors = sectorsOf(*part);
        if (begun_ && continues(covered_, sectors)) {
            append(*begun_, *part);
            covered_ |= sectors;
            continue;
        }
        auto turn = std::exchange(begun_, std::move(part));
        covered_ = sectors;
        begun_->index = turns_++;
        if (!turn) continue;
        findings_.add("messages that hold a part of a turn: put together", turn->index);
        return turn;
    }
    return std::exchange(begun_, std::nullopt);
}

bool TurnAssembler::skip() {
    if (areParts_ || !ahead_.empty()) return next().has_value();
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    return source_->skip();
}

std::optional<double> TurnAssembler::fraction() const {
    return fractions_.empty() ? source_->fraction() : fractions_.front();
}

Recording TurnAssembler::recording() const {
    Recording recording = source_->recording();
    if (areParts_) recording.scans.reset();
    const auto lines = findings_.lines();
    recording.findings.insert(recording.findings.end(), lines.begin(), lines.end());
    return recording;
}
}  // namespace delio::io
