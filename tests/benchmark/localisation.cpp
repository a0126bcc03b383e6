// How well a drive is localised in a stored map (share/doc/stored_map.md). Both drives with
// DRIVE.poses.txt, DRIVE.calib.txt and DRIVE.times.txt beside them, and DRIVE.origin.txt if they
// are two drives through one world (synth2rawlog).
//   benchmark_localisation MAP.delio MAPPED.rawlog DRIVE.rawlog [--start N] [--every N]
//                          [--places N] [--elsewhere] [--list] [--own OWN POSE.txt]
//                          [--around M]
//                          --own: MAP was imported from a cloud of OWN, a map.delio or another
//                          program's poses (TUM, stamps of MAPPED), which POSE.txt (one row in
//                          KITTI's format) brings into the cloud (share/scripts/foreign-maps)
//                          --around M: errors are relative to the mean of the poses of OWN within
//                          M metres, which the cloud shows, and not to the nearest pose
//   benchmark_localisation --seam MAP.delio FIRST.rawlog SECOND.rawlog
//                          how well two drives of one map fit together where they meet
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/summary.h"
#include "delio/slam/localiser.h"
#include "delio/slam/options.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;

struct Settings {
    std::string map, mapped, drive, own, ownPose;
    std::size_t start = 0, every = 1, places = 100;
    double around_m = 0;
    bool elsewhere = false;  // the drive is in another world: nothing may be found
    bool list = false;
    bool seam = false;
};

/** True poses of the vehicle in the world, by scan. */
std::vector<Isometry3d> truePoses(const std::string& rawlog) {
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    auto poses = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    const std::string origin = io::sidecarPath(rawlog, ".origin.txt");
    Isometry3d first = Isometry3d::Identity();  // of cam0
    if (std::filesystem::exists(origin)) first = io::readTrajectory(origin).poses.front();
    const Isometry3d zero = poses.front();
    for (auto& pose : poses) pose = first * zero.inverse() * pose * Tr;
    return poses;
}

/** Poses that are known twice: as the map has them, and truly. */
class MapTruth {
 public:
    MapTruth(const StoredMap& map, const StoredDrive& drive, const std::string& rawlog)
        : MapTruth(map.trajectory(drive), rawlog) {}

    MapTruth(const io::Trajectory& known, const std::string& rawlog) {
        const auto truth = truePoses(rawlog);
        std::map<long, std::size_t> scanAt;  // by milliseconds
        const auto reader = io::openScans(rawlog);
        std::size_t number = 0;
        for (auto scan = reader->next(); scan; scan = reader->next(), ++number)
            scanAt[std::lround(1000 * scan->stamp_s)] = number;
        for (std::size_t i = 0; i < known.stamps_s.size(); ++i) {
            const auto at = scanAt.find(std::lround(1000 * known.stamps_s[i]));
            if (at == scanAt.end() || at->second >= truth.size()) continue;
            true_.push_back(truth[at->second]);
            mapped_.push_back(known.poses[i]);
        }
    }

    /** The map's poses in another map. */
    void move(const Isometry3d& otherFromMap) {
        for (auto& pose : mapped_) pose = otherFromMap * pose;
    }

    /** Where the map has what is truly there: by the nearest pose that it was made of. */
    Isometry3d inMap(const Isometry3d& truth, double& distance) const {
        std::size_t best = 0;
        distance = 1e9;
        for (std::size_t i = 0; i < true_.size(); ++i) {
            const double d = (true_[i].translation() - truth.translation()).norm();
            if (d >= distance) continue;
            distance = d;
            best = i;
        }
        return mapped_[best] * true_[best].inverse() * truth;
    }
    /** Each pose becomes what those around it say of it, on average. */
    void average(double around_m) {
        const auto known = mapped_;
        for (std::size_t i = 0; i < known.size(); ++i) {
            Vector6 sum = Vector6::Zero();
            double count = 0;
            for (std::size_t k = 0; k < known.size(); ++k) {
                if ((true_[k].translation() - true_[i].translation()).norm() > around_m) continue;
                sum += poseLog(known[i].inverse() * known[k] * true_[k].inverse() * true_[i]);
                ++count;
            }
            mapped_[i] = known[i] * poseExp(sum / count);
        }
    }

    /** Drops poses about which a map has less than half of what it usually has: it was cut off. */
    void keepWithin(const Eigen::Matrix3Xf& cloud) {
        constexpr float kAround_m = 25;
        std::vector<Eigen::Index> counts;
        for (const auto& pose : mapped_) {
            const Eigen::Vector3f at = pose.translation().cast<float>();
            counts.push_back(((cloud.colwise() - at).colwise().norm().array() < kAround_m).count());
        }
        auto sorted = counts;
        std::sort(sorted.begin(), sorted.end());
        const Eigen::Index usual = sorted.empty() ? 0 : sorted[sorted.size() * 3 / 4];
        std::size_t kept = 0;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            if (2 * counts[i] < usual) continue;
            true_[kept] = true_[i];
            mapped_[kept++] = mapped_[i];
        }
        true_.resize(kept);
        mapped_.resize(kept);
    }
    const std::vector<Isometry3d>& truth() const { return true_; }
    const std::vector<Isometry3d>& mapped() const { return mapped_; }

 private:
    std::vector<Isometry3d> true_, mapped_;
};

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const auto i = static_cast<std::size_t>(share * static_cast<double>(values.size()));
    return values[std::min(i, values.size() - 1)];
}

constexpr double kDeg = M_PI / 180;
constexpr double kRight_m = 0.5, kRight_rad = 2 * kDeg;
constexpr double kMapped_m = 8;  // nearer to a pose of the map: there is one
constexpr std::size_t kScans = 5;

struct Starts {
    std::size_t all = 0, found = 0, wrong = 0, unmapped = 0;
    std::vector<double> fix_ms, scans;
};

struct Tracking {
    std::vector<double> off_m, off_deg, ms, localisation_ms, share, outsideShare;
    std::size_t scans = 0, inMap = 0, wrong = 0, mappedNotIn = 0;
};

void startAt(const std::shared_ptr<const StoredMap>& map, const std::vector<Scan>& scans,
             std::size_t first, const std::vector<Isometry3d>& truth, const MapTruth& mapTruth,
             const Settings& settings, const OdometryOptions& options, Starts& starts) {
    Localiser localiser(map, options);
    double distance = 0;
    mapTruth.inMap(truth[scans[0].index], distance);
    const bool mapped = !settings.elsewhere && distance < kMapped_m;
    mapped ? ++starts.all : ++starts.unmapped;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        Stopwatch watch;
        const auto found = localiser.process(scans[i]);
        const double ms = watch.lap_ms();
        if (found.fix.searched) starts.fix_ms.push_back(ms);
        if (found.fix.where == Whereabouts::kUnknown) {
            if (settings.list && i + 1 == scans.size())
                std::printf("    start %zu (%.1f m from the map): %s, share %.2f\n", first,
                            distance, found.fix.reason.c_str(), found.fix.inlierRatio);
            continue;
        }
        const Isometry3d off =
            mapTruth.inMap(truth[scans[i].index], distance).inverse() * found.fix.vehicle.pose;
        const bool right = !settings.elsewhere && off.translation().norm() < kRight_m &&
                           angleOf(off.linear()) < kRight_rad;
        if (right && mapped) ++starts.found;
        if (!right) {
            ++starts.wrong;
            std::printf("    start %zu: WRONG by %.2f m %.2f deg, share %.2f\n", first,
                        off.translation().norm(), angleOf(off.linear()) / kDeg,
                        found.fix.inlierRatio);
        }
        starts.scans.push_back(static_cast<double>(i + 1));
        return;
    }
}

/** One scan of the whole drive. */
void note(const Localisation& found, double ms, const Scan& scan, const Isometry3d& truth,
          const MapTruth& mapTruth, const Settings& settings, Tracking& tracking) {
    double odometry_ms = 0, distance = 0;
    for (const auto& [name, time] : found.step.times_ms) odometry_ms += time;
    const Isometry3d off = mapTruth.inMap(truth, distance).inverse() * found.fix.vehicle.pose;
    const double off_m = off.translation().norm(), off_rad = angleOf(off.linear());
    ++tracking.scans;
    if (found.fix.where != Whereabouts::kInMap || !found.fix.measured) {
        tracking.outsideShare.push_back(found.fix.inlierRatio);
        if (distance < kMapped_m) ++tracking.mappedNotIn;
        if (settings.list)
            std::printf("    scan %zu (%.1f m from the map): %s, share %.2f\n", scan.index,
                        distance, found.fix.reason.c_str(), found.fix.inlierRatio);
        return;
    }
    ++tracking.inMap;
    tracking.off_m.push_back(off_m);
    tracking.off_deg.push_back(off_rad / kDeg);
    tracking.share.push_back(found.fix.inlierRatio);
    if (settings.elsewhere || off_m > kRight_m || off_rad > kRight_rad) ++tracking.wrong;
    if (found.fix.searched) return;
    tracking.ms.push_back(ms);
    tracking.localisation_ms.push_back(ms - odometry_ms);
}

void print(const Starts& starts, const Tracking& tracking) {
    std::printf(
        "  starts: found within %zu scans %zu of %zu on mapped streets, wrong %zu, not mapped "
        "%zu; scans %.0f median; search %.0f ms median, %.0f at most\n",
        kScans, starts.found, starts.all, starts.wrong, starts.unmapped,
        quantile(starts.scans, 0.5), quantile(starts.fix_ms, 0.5), quantile(starts.fix_ms, 1));
    std::printf(
        "  tracked %zu of %zu scans, wrong %zu, mapped and not tracked %zu: %.4f m %.4f deg "
        "median, %.4f m %.4f deg 95 %%, at most %.3f m %.3f deg; share %.2f at least, 5 %% %.2f, "
        "outside %.2f at most\n",
        tracking.inMap, tracking.scans, tracking.wrong, tracking.mappedNotIn,
        quantile(tracking.off_m, 0.5), quantile(tracking.off_deg, 0.5),
        quantile(tracking.off_m, 0.95), quantile(tracking.off_deg, 0.95),
        quantile(tracking.off_m, 1), quantile(tracking.off_deg, 1), quantile(tracking.share, 0),
        quantile(tracking.share, 0.05), quantile(tracking.outsideShare, 1));
    std::printf(
        "  ms a scan: %.1f with odometry (at most %.1f), of them localisation %.1f (at most %.1f); "
        "peak %.0f MB\n",
        quantile(tracking.ms, 0.5), quantile(tracking.ms, 1),
        quantile(tracking.localisation_ms, 0.5), quantile(tracking.localisation_ms, 1),
        run::peakMemory_mb());
}

/** As the program knows it that wrote the cloud. */
MapTruth ownTruth(const Settings& settings) {
    if (std::filesystem::path(settings.own).extension() != ".delio")
        return {io::readTrajectory(settings.own), settings.mapped};
    const StoredMap own(settings.own);
    return {own, own.drives().front(), settings.mapped};
}

MapTruth truthOf(const StoredMap& map, const Settings& settings) {
    if (settings.own.empty()) return {map, map.drives().front(), settings.mapped};
    MapTruth truth = ownTruth(settings);
    Isometry3d inCloud = io::readTrajectory(settings.ownPose).poses.at(0);
    inCloud.translation() -= map.cloudOrigin().value().offset;
    truth.move(inCloud);
    if (settings.around_m > 0) truth.average(settings.around_m);
    truth.keepWithin(map.cloud(0.3));
    return truth;
}

/** Along the poses of the map. */
double pathOf(const MapTruth& truth) {
    double path_m = 0;
    for (std::size_t i = 1; i < truth.mapped().size(); ++i)
        path_m += (truth.mapped()[i].translation() - truth.mapped()[i - 1].translation()).norm();
    return path_m;
}

/** All of the drive in one go, and starts beside it. */
void measure(const Settings& settings) {
    const auto map = std::make_shared<const StoredMap>(settings.map);
    const auto truth = truePoses(settings.drive);
    const MapTruth mapTruth = truthOf(*map, settings);
    const auto options = Options::forDrive("accurate", io::readDriveMeta(settings.drive));
    const double path_m = pathOf(mapTruth);
    Stopwatch watch;
    Localiser localiser(map, options);
    const double opened_ms = watch.lap_ms();
    Tracking tracking;
    Starts starts;
    const auto count = (truth.size() - settings.start + settings.every - 1) / settings.every;
    const auto apart = std::max<std::size_t>(1, count / std::max<std::size_t>(1, settings.places));
    std::deque<Scan> last;
    const auto reader = io::openScans(settings.drive);
    for (std::size_t i = 0; i < settings.start; ++i) reader->skip();
    std::size_t number = 0;
    for (auto scan = reader->next(); scan && scan->index < truth.size(); ++number) {
        last.push_back(*scan);
        if (last.size() > kScans) last.pop_front();
        if (settings.places > 0 && number % apart == (kScans - 1) % apart && last.size() == kScans)
            startAt(map, {last.begin(), last.end()}, last.front().index, truth, mapTruth, settings,
                    options, starts);
        watch.lap_ms();
        const auto found = localiser.process(*scan);
        note(found, watch.lap_ms(), *scan, truth[scan->index], mapTruth, settings, tracking);
        for (std::size_t i = 1; i < settings.every; ++i) reader->skip();
        scan = reader->next();
    }
    std::printf("%s in %s (%.0f m, %zu submaps, %.2f MB per 100 m), opened in %.0f ms\n",
                settings.drive.c_str(), settings.map.c_str(), path_m, map->submaps().size(),
                static_cast<double>(std::filesystem::file_size(settings.map)) / 1e4 / path_m,
                opened_ms);
    print(starts, tracking);
}

void measureSeam(const Settings& settings) {
    const StoredMap map(settings.map);
    if (map.drives().size() < 2) throw Error("the map has one drive only");
    const MapTruth first(map, map.drives()[0], settings.mapped),
        second(map, map.drives()[1], settings.drive);
    std::vector<double> off_m, off_deg, apart_m;
    for (std::size_t i = 0; i < second.truth().size(); ++i) {
        double distance = 0;
        const Isometry3d off =
            first.inMap(second.truth()[i], distance).inverse() * second.mapped()[i];
        apart_m.push_back(distance);
        if (distance > kMapped_m) continue;
        off_m.push_back(off.translation().norm());
        off_deg.push_back(angleOf(off.linear()) / kDeg);
    }
    std::printf(
        "%s: %zu of %zu scans of the second drive within %.0f m of the first: off %.4f m %.4f deg "
        "median, at most %.4f m %.4f deg; the others up to %.0f m away\n",
        settings.map.c_str(), off_m.size(), apart_m.size(), kMapped_m, quantile(off_m, 0.5),
        quantile(off_deg, 0.5), quantile(off_m, 1), quantile(off_deg, 1), quantile(apart_m, 1));
}
}  // namespace

int main(int argc, char** argv) {
    try {
        Settings settings;
        std::vector<std::string> files;
        for (int i = 1; i < argc; ++i) {
            const std::string word = argv[i];
            const auto number = [&] { return std::stoul(argv[++i]); };
            if (word == "--list")
                settings.list = true;
            else if (word == "--seam")
                settings.seam = true;
            else if (word == "--elsewhere")
                settings.elsewhere = true;
            else if (word == "--own" && i + 2 < argc) {
                settings.own = argv[++i];
                settings.ownPose = argv[++i];
            } else if (word == "--around" && i + 1 < argc)
                settings.around_m = std::stod(argv[++i]);
            else if (word == "--start" && i + 1 < argc)
                settings.start = number();
            else if (word == "--every" && i + 1 < argc)
                settings.every = number();
            else if (word == "--places" && i + 1 < argc)
                settings.places = number();
            else
                files.push_back(word);
        }
        if (files.size() != 3) throw Error("wants MAP.delio MAPPED.rawlog DRIVE.rawlog");
        settings.map = files[0];
        settings.mapped = files[1];
        settings.drive = files[2];
        settings.seam ? measureSeam(settings) : measure(settings);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "benchmark_localisation: %s\n", e.what());
        return 1;
    }
    return 0;
}
