#include "delio/run/playback.h"

#include <chrono>
#include <future>
#include <utility>

#include "core/spread_threads.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/formats/georeference.h"

namespace delio::run {
Playback::Playback(io::ScanReader& reader, PlaybackSettings settings)
    : reader_(reader), settings_(std::move(settings)) {
    Stopwatch watch;
    now_ = read(settings_.start);
    read_ms_ = now_.received_s ? 0 : watch.lap_ms();
}

Playback::Reading Playback::read(std::size_t passedOver) {
    for (std::size_t i = 0; i < passedOver; ++i) {
        if (isInterrupted()) return {};
        if (!reader_.skip()) break;
    }
    auto scan = reader_.next();
    return {std::move(scan), reader_.takeImu(), reader_.takeOdometry(), reader_.fraction(),
            reader_.received_s()};
}

/** The next scan is read while this one is registered; `read_ms_` is the waiting time. */
void Playback::processAll(Run& run, const OnScan& onScan) {
    std::optional<SpreadThreads> spread;
    if (now_.received_s) spread.emplace();
    const auto policy = settings_.readAhead ? std::launch::async : std::launch::deferred;
    for (std::size_t done = 1; now_.scan; ++done) {
        // Do not read beyond the last scan: a fault there does not matter.
        const bool isLast = done == settings_.count;
        std::future<Reading> next;
        if (!isLast) next = std::async(policy, [&] { return read(settings_.every - 1); });
        if (settings_.imu)
            for (const auto& sample : now_.imu) run.addImu(sample);
        if (settings_.odometry)
            for (const auto& sample : now_.odometry) run.addOdometry(sample);
        const RunRow row = run.process(*now_.scan, read_ms_);
        const auto latency = latency_ms();
        if (onScan) onScan(row, {now_.fraction, latency});
        if (latency) run.settle();
        if (isLast || isInterrupted()) break;
        Stopwatch watch;
        now_ = next.get();
        // One waits for a live sensor, whatever the time that reading takes.
        read_ms_ = now_.received_s ? 0 : watch.lap_ms();
    }
}

/** Of the scan that was just processed. */
std::optional<double> Playback::latency_ms() {
    if (!now_.received_s) return {};
    const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
    latencies_ms_.push_back(1e3 * (now.count() - *now_.received_s));
    return latencies_ms_.back();
}

void Playback::addLive(Run& run) {
    const auto sensor = reader_.live();
    if (!sensor) return;
    run.add(LiveRecord{*sensor, latencies_ms_});
    if (sensor->droppedScans > 0)
        run.warn(std::to_string(sensor->droppedScans) +
                 " scans were dropped because they came faster than they could be processed; a run "
                 "of the recorded packets uses all");
    if (sensor->lostPackets > 0)
        run.warn(std::to_string(sensor->lostPackets) +
                 " packets were lost because the system's buffer was full; increase "
                 "net.core.rmem_max");
    if (sensor->notRecorded > 0)
        run.warn(std::to_string(sensor->notRecorded) +
                 " packets are missing in the recording: the disk was too slow");
}

/** Fixes of a recording may be missing or damaged; those that the user gives may not. */
void Playback::addFixes(Run& run) {
    if (!settings_.gnss) return;
    const bool areGiven = !settings_.fixes.empty();
    try {
        auto fixes = reader_.takeFixes();
        if (areGiven) {
            fixes = io::readFixes(settings_.fixes);
            io::countFrom(reader_.meta() ? reader_.meta()->epoch_s : 0, fixes);
        }
        if (settings_.antenna)
            for (auto& fix : fixes) fix.antenna = *settings_.antenna;
        run.add(fixes);
    } catch (const Error& e) {
        const std::string what = "the GNSS fixes cannot be used: " + std::string(e.what());
        areGiven ? run.fail(what) : run.warn(what);
    }
}

void Playback::play(Run& run, const OnScan& onScan) {
    for (const auto& warning : reader_.recording().warnings) run.warn(warning);
    try {
        processAll(run, onScan);
    } catch (const std::exception& e) {
        // An interrupt ends standard input anywhere within a scan.
        if (!isInterrupted()) run.fail(plainMessage(e));
    }
    for (const auto& warning : warningsOfOthers(reader_)) run.warn(warning);
    addFixes(run);
    addLive(run);
    const auto recording = reader_.recording();
    for (const auto& finding : recording.findings) run.warn(finding);
    if (const auto scan = recording.compensatedAfterAll)
        run.warn("from scan " + std::to_string(*scan) +
                 " on, the points look de-skewed by the recorder, unlike before; run again with "
                 "--set scan.deskew=false");
}

std::vector<std::string> warningsOfOthers(const io::ScanReader& reader) {
    std::vector<std::string> warnings;
    for (const auto& other : reader.otherLabels()) warnings.push_back(io::warningOfOther(other));
    return warnings;
}
}  // namespace delio::run
