#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "delio/recordings/scan_feed.h"
#include "live_source.h"
#include "recognised_reader.h"
#include "sources.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
/** Scans of a live sensor. A thread decodes packets; who asks for scans may be slower. */
class LiveReader : public ScanReader {
 public:
    LiveReader(std::shared_ptr<LiveSource> packets, std::unique_ptr<ScanReader> scans,
               const LiveSettings& settings);
    ~LiveReader() override;

    std::optional<Scan> next() override;
    bool skip() override { return next().has_value(); }
    std::vector<ImuSample> takeImu() override { return std::exchange(imu_, {}); }
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override;
    std::optional<double> fraction() const override { return {}; }
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override;
    std::optional<LiveReport> live() const override;
    std::optional<double> received_s() const override { return received_s_; }

 private:
    void run();
    void publish();

    std::shared_ptr<LiveSource> packets_;
    std::unique_ptr<ScanReader> scans_;  //!< belongs to the thread
    std::string label_;
    std::optional<DriveMeta> meta_;
    ScanFeed feed_;
    std::vector<ImuSample> imu_;
    std::optional<double> received_s_;
    mutable std::mutex mutex_;  //!< of the next two
    Recording recording_;
    std::set<std::string> others_;
    mutable std::set<std::string> shownOthers_;
    std::thread thread_;
};

LiveReader::LiveReader(std::shared_ptr<LiveSource> packets, std::unique_ptr<ScanReader> scans,
                       const LiveSettings& settings)
    : packets_(std::move(packets)),
      scans_(std::move(scans)),
      label_(scans_->label()),
      meta_(scans_->meta()),
      feed_(settings.mostWaiting, [warn = settings.onWarning] {
          if (warn) warn("scans come faster than they are processed: some are dropped");
      }) {
    publish();
    thread_ = std::thread([this] { run(); });
}

LiveReader::~LiveReader() {
    packets_->stop();
    thread_.join();
}

void LiveReader::run() {
    try {
        while (auto scan = scans_->next()) {
            for (const ImuSample& sample : scans_->takeImu()) feed_.add(sample);
            publish();
            const auto received_s = packets_->receivedOf(scan->index);
            feed_.add(std::move(*scan), received_s);
        }
        publish();
        feed_.close();
    } catch (const std::exception&) {
        publish();
        feed_.close(std::current_exception());
    }
}

void LiveReader::publish() {
    Recording recording = scans_->recording();
    const std::lock_guard lock(mutex_);
    recording_ = std::move(recording);
    others_ = scans_->otherLabels();
}

std::optional<Scan> LiveReader::next() {
    auto item = feed_.take();
    if (!item) return {};
    imu_.insert(imu_.end(), item->imu.begin(), item->imu.end());
    received_s_ = item->received_s;
    return std::move(item->scan);
}

const std::set<std::string>& LiveReader::otherLabels() const {
    const std::lock_guard lock(mutex_);
    return shownOthers_ = others_;
}

Recording LiveReader::recording() const {
    const std::lock_guard lock(mutex_);
    return recording_;
}

std::optional<LiveReport> LiveReader::live() const {
    return LiveReport{packets_->packets(), packets_->lost(), packets_->notRecorded(),
                      feed_.dropped()};
}

/** An Ouster's recording is read with the json beside it. */
void keepJson(const ScanSource& source) {
    const fs::path json = source.sensorFile;
    if (source.live.record.empty() || json.extension() != ".json") return;
    const fs::path beside = fs::path(source.live.record).replace_extension(".json");
    std::error_code fault;
    if (fs::equivalent(json, beside, fault)) return;
    fs::copy_file(json, beside, fs::copy_options::overwrite_existing, fault);
    if (fault && source.live.onWarning)
        source.live.onWarning("cannot copy '" + json.string() + "' beside the recording (" +
                              fault.message() + "); it is needed to read that");
}
}  // namespace

std::unique_ptr<ScanReader> openLive(const ScanSource& source) {
    auto packets = std::make_shared<LiveSource>(source.path, source.live);
    auto scans =
        std::make_unique<RecognisedReader>(openPackets(source, packets), Delivery::kSensor);
    keepJson(source);
    return std::make_unique<LiveReader>(std::move(packets), std::move(scans), source.live);
}
}  // namespace delio::io
