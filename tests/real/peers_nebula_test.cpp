// Packets that TIER IV's nebula recorded, and the clouds that it made of them: DELIO_PEER_DATA
// names the folder that holds a checkout of github.com/tier4/nebula.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "delio/recordings/scan_reader.h"
#include "recordings/beam_angles.h"
#include "recordings/hesai_at128.h"
#include "recordings/packet_decoder.h"
#include "spinning_packets.h"
#include "test_data.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

fs::path nebula(const std::string& maker) {
    const char* const folder = std::getenv("DELIO_PEER_DATA");
    return fs::path(folder ? folder : "") / "nebula/src" / ("nebula_" + maker);
}

std::vector<fs::path> filesIn(const fs::path& folder, const std::string& extension) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().extension() == extension) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<Eigen::Vector3f> pointsOf(const Scan& scan) {
    std::vector<Eigen::Vector3f> points(scan.points->size());
    for (std::size_t i = 0; i < points.size(); ++i)
        scan.points->getPoint(i, points[i].x(), points[i].y(), points[i].z());
    return points;
}

std::vector<Eigen::Vector3f> cloudOf(const fs::path& pcd) {
    const test::TemporaryFolder folder;
    fs::copy_file(pcd, folder / "1.pcd");
    return pointsOf(io::openScans(folder.path().string())->next().value());
}

/** What scans have in common with a cloud. nebula cuts turns where a beam passes the cut, DeLiO
 * where its block does: a cloud ends with beams that lag behind the first block of the next turn,
 * which is no scan where the recording ends with it. */
struct Agreement {
    std::size_t points = 0, ofNextTurn = 0, missing = 0;
    double worst_m = 0;
    double worstUp_deg = 0;  //!< of a point from its ring's elevation
};

/** Points by ranges and elevations. */
class Points {
 public:
    void add(const Scan& scan) {
        const auto points = pointsOf(scan);
        for (std::size_t i = 0; i < points.size(); ++i)
            cells_[keyOf(points[i], 0, 0)].push_back({points[i], scan.rings[i]});
    }

    struct Point {
        Eigen::Vector3f xyz;
        std::uint16_t ring;
    };
    /** The nearest one with this range and elevation. */
    const Point* nearest(const Eigen::Vector3f& to) const {
        const Point* best = nullptr;
        for (int r = -1; r <= 1; ++r)
            for (int e = -1; e <= 1; ++e) {
                const auto cell = cells_.find(keyOf(to, r, e));
                if (cell == cells_.end()) continue;
                for (const Point& point : cell->second)
                    if (!best || (point.xyz - to).norm() < (best->xyz - to).norm()) best = &point;
            }
        return best;
    }

 private:
    using Key = std::pair<long, long>;
    static Key keyOf(const Eigen::Vector3f& p, int ranges, int elevations) {
        constexpr float kRange = 0.002F, kElevation = 0.0002F;
        return {std::lround(p.norm() / kRange) + ranges,
                std::lround(std::asin(p.z() / p.norm()) / kElevation) + elevations};
    }
    std::map<Key, std::vector<Point>> cells_;
};

double degrees(double rad) { return rad * 180 / M_PI; }

/** True for a Hesai's point before azimuth 0, whose block lies behind it. */
bool beginsATurn(const Eigen::Vector3f& point, const std::vector<io::BeamAngles>& angles) {
    const double up = degrees(std::asin(double{point.z() / point.norm()}));
    const double across = degrees(std::atan2(double{point.x()}, double{point.y()}));
    return std::any_of(angles.begin(), angles.end(), [&](const io::BeamAngles& beam) {
        const double block = across - beam.azimuth_deg;
        return std::abs(up - beam.elevation_deg) < 0.001 && block > -0.001 && across < 0.001;
    });
}

Agreement agreementOf(const fs::path& bag, const std::vector<fs::path>& clouds,
                      const std::vector<io::BeamAngles>& angles) {
    constexpr float kSame_m = 0.0001F;
    const auto reader = io::openScans(bag.string());
    Points ours;
    while (const auto scan = reader->next()) {
        EXPECT_EQ(scan->times_s.size(), scan->points->size());
        EXPECT_EQ(scan->rings.size(), scan->points->size());
        ours.add(*scan);
    }
    Agreement found;
    for (const fs::path& cloud : clouds)
        for (const auto& point : cloudOf(cloud)) {
            ++found.points;
            const auto* same = ours.nearest(point);
            if (!same || (same->xyz - point).norm() > kSame_m) {
                ++(beginsATurn(point, angles) ? found.ofNextTurn : found.missing);
                continue;
            }
            found.worst_m = std::max(found.worst_m, double{(same->xyz - point).norm()});
            const double up = degrees(std::asin(double{point.z() / point.norm()}));
            found.worstUp_deg =
                std::max(found.worstUp_deg, std::abs(up - angles.at(same->ring).elevation_deg));
        }
    std::cout << reader->recording().sensor << ": " << found.points << " points, "
              << found.ofNextTurn << " of the next turn, " << found.missing << " missing, worst "
              << found.worst_m << " m, rings " << found.worstUp_deg << " deg\n";
    return found;
}

struct Case {
    const char *folder, *angles;
    std::size_t lasers;
};

TEST(Peers, HesaiPacketsAsNebulaDecodesThem) {
    const fs::path root = nebula("hesai");
    if (!fs::exists(root)) GTEST_SKIP() << "DELIO_PEER_DATA has no nebula";
    for (const Case& model :
         {Case{"40p", "Pandar40P", 40}, Case{"64", "Pandar64", 64}, Case{"xt16", "PandarXT16", 16},
          Case{"xt32", "PandarXT32", 32}, Case{"xt32m", "PandarXT32M", 32},
          Case{"qt64", "PandarQT64", 64}, Case{"qt128", "PandarQT128", 128}}) {
        SCOPED_TRACE(model.folder);
        const fs::path data =
            root / "nebula_hesai/test_resources/decoder_ground_truth" / model.folder;
        const auto bags = filesIn(data, ".db3"), clouds = filesIn(data, ".pcd");
        ASSERT_FALSE(bags.empty());
        ASSERT_FALSE(clouds.empty());
        const auto angles = io::readBeamAngles(
            (root / "nebula_hesai_decoders/calibration" / (std::string(model.angles) + ".csv"))
                .string(),
            model.lasers);
        const Agreement found = agreementOf(bags.front(), clouds, angles);
        EXPECT_GT(found.points, 5000U);
        EXPECT_EQ(found.missing, 0U);
        EXPECT_LT(100 * found.ofNextTurn, found.points);
        EXPECT_LT(found.worst_m, 2e-5);
        EXPECT_LT(found.worstUp_deg, 0.001);
    }
}

/** The packets of a cloud: its points lie on the grid of azimuths, distances and lasers, two of
 *  some lasers. */
std::vector<test::TimedPacket> packetsOf(const std::vector<Eigen::Vector3f>& cloud,
                                         const std::vector<io::BeamAngles>& angles) {
    test::HesaiToy toy = test::hesai128Toy(true);
    toy.mode = 0x39;
    toy.begin = 1;
    toy.step = 10;
    toy.next_us = 27.778;
    toy.state = 0;
    std::map<std::pair<int, std::size_t>, std::vector<int>> distances;
    for (const auto& point : cloud) {
        const double up = degrees(std::asin(double{point.z() / point.norm()}));
        const auto beam = std::min_element(
            angles.begin(), angles.end(), [up](const auto& one, const auto& other) {
                return std::abs(one.elevation_deg - up) < std::abs(other.elevation_deg - up);
            });
        const double across = degrees(std::atan2(double{point.x()}, double{point.y()}));
        const auto azimuth =
            static_cast<int>(std::lround(100 * (across - beam->azimuth_deg) + 36000)) % 36000;
        distances[{azimuth, static_cast<std::size_t>(beam - angles.begin())}].push_back(
            static_cast<int>(std::lround(250 * double{point.norm()})));
    }
    return test::hesaiDrive(
        toy, 1.6, 1700000000, [&](std::size_t laser, int azimuth, std::size_t which) {
            const auto at = distances.find({azimuth, laser});
            return at != distances.end() && which < at->second.size() ? at->second[which] : 0;
        });
}

/** nebula's recording of an OT128 is not at hand, its cloud is: packets made of it have to give the
 * cloud again, with the beam angles that nebula has. */
TEST(Peers, Ot128CloudOfNebulaFromPacketsMadeOfIt) {
    const fs::path root = nebula("hesai");
    if (!fs::exists(root)) GTEST_SKIP() << "DELIO_PEER_DATA has no nebula";
    const auto clouds =
        filesIn(root / "nebula_hesai/test_resources/decoder_ground_truth/ot128", ".pcd");
    ASSERT_FALSE(clouds.empty());
    const std::string file = (root / "nebula_hesai_decoders/calibration/Pandar128E4X.csv").string();
    const auto cloud = cloudOf(clouds.front());
    const auto decoder = io::hesaiDecoder(file);
    for (const auto& packet : packetsOf(cloud, io::readBeamAngles(file, 128)))
        decoder->add(packet.bytes.data(), packet.bytes.size(), packet.time_s);
    const auto scan = decoder->take();
    ASSERT_TRUE(scan);
    Points ours;
    ours.add(*scan);
    double worst_m = 0;
    for (const auto& point : cloud) {
        const auto* same = ours.nearest(point);
        worst_m = std::max(worst_m, same ? double{(same->xyz - point).norm()} : 1);
    }
    std::cout << "OT128: " << cloud.size() << " points, " << scan->points->size()
              << " from packets, worst " << worst_m << " m\n";
    EXPECT_EQ(scan->points->size(), cloud.size());
    EXPECT_LT(worst_m, 5e-5);
}

/** Of nebula's AT128 there is the cloud, without the packets: each point has to lie on a beam of
 * its correction file, at an angle of the mirror that a packet can tell. nebula rounds corrections
 * to 0.01 deg, DeLiO interpolates them. */
TEST(Peers, At128CloudOfNebulaLiesOnTheBeams) {
    const fs::path root = nebula("hesai");
    if (!fs::exists(root)) GTEST_SKIP() << "DELIO_PEER_DATA has no nebula";
    const auto clouds =
        filesIn(root / "nebula_hesai/test_resources/decoder_ground_truth/at128", ".pcd");
    ASSERT_FALSE(clouds.empty());
    const io::At128Angles angles(
        (root / "nebula_hesai_decoders/calibration/PandarAT128.dat").string());
    double worst_deg = 0;
    const auto cloud = cloudOf(clouds.front());
    for (const auto& point : cloud) {
        const double up = degrees(std::asin(double{point.z() / point.norm()}));
        const double across = degrees(std::atan2(double{point.x()}, double{point.y()}));
        double least_deg = 90;
        for (std::size_t field = 0; field < 3; ++field)
            for (std::size_t laser = 0; laser < io::kAt128Lasers; ++laser) {
                // The mirror's angle at which the beam has the point's azimuth.
                const double begin = angles.direction(field, 0, laser).azimuth;
                double mirror = (across - begin) / 2;
                mirror += (across - angles.direction(field, mirror, laser).azimuth) / 2;
                std::size_t own = 0;
                if (mirror < 0 || mirror >= 360 || angles.withinField(mirror, own) < 0 ||
                    own != field)
                    continue;
                least_deg = std::min(
                    least_deg, std::abs(up - angles.direction(field, mirror, laser).elevation));
            }
        worst_deg = std::max(worst_deg, least_deg);
    }
    std::cout << "AT128: " << cloud.size() << " points, worst " << worst_deg
              << " deg from a beam's elevation\n";
    EXPECT_GT(cloud.size(), 10000U);
    EXPECT_LT(worst_deg, 0.011);
}

/** nebula turns a VLS-128 on within some of its blocks only, and so is up to 0.17 deg behind. */
TEST(Peers, Vls128PacketsAsNebulaDecodesThem) {
    const fs::path root = nebula("velodyne");
    if (!fs::exists(root)) GTEST_SKIP() << "DELIO_PEER_DATA has no nebula";
    const fs::path data = root / "nebula_velodyne/test_resources/decoder_ground_truth/vls128";
    const auto reader = io::openScans(filesIn(data, ".db3").at(0).string());
    EXPECT_EQ(reader->recording().sensor, "Velodyne VLS-128");
    Points ours;
    while (const auto scan = reader->next()) ours.add(*scan);
    std::size_t points = 0, missing = 0;
    double worst_deg = 0, worstUp_deg = 0;
    for (const auto& point : cloudOf(filesIn(data, ".pcd").at(0))) {
        ++points;
        const auto* same = ours.nearest(point);
        const double off = same ? std::atan2(double{same->xyz.y()}, double{same->xyz.x()}) -
                                      std::atan2(double{point.y()}, double{point.x()})
                                : M_PI;
        const double off_deg = std::abs(degrees(std::remainder(off, 2 * M_PI)));
        if (off_deg > 0.18) {
            ++missing;
            continue;
        }
        worst_deg = std::max(worst_deg, off_deg);
        worstUp_deg = std::max(
            worstUp_deg, std::abs(degrees(std::asin(double{point.z() / point.norm()}) -
                                          std::asin(double{same->xyz.z() / same->xyz.norm()}))));
    }
    std::cout << "VLS-128: " << points << " points, " << missing << " missing, worst " << worst_deg
              << " deg across, " << worstUp_deg << " deg up\n";
    EXPECT_GT(points, 100'000U);
    EXPECT_EQ(missing, 0U);
    EXPECT_LT(worstUp_deg, 0.001);
}
}  // namespace
