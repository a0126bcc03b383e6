// Several LiDARs of a bag.
#include "bag_files.h"
#include "delio/recordings/scan_reader.h"

namespace delio::bag_test {
namespace {
/** Two sensors with a cloud of 5 points per scan: x = 10 + scan, y = 0 ... 4. */
BagContents twoSensors(Kind kind) {
    BagContents bag = drive(0, kind);
    bag.topics.push_back({"/rear/points", bag.topics[0].type});
    for (int i = 0; i < 4; ++i) {
        CloudSpec cloud;
        cloud.columns = 5;
        cloud.scan = i;
        cloud.stamp_s = kBegin_s + 0.1 * i;
        cloud.frame = "front";
        bag.messages.push_back({0, cloud.stamp_s, cloudMessage(cloud, kind)});
        cloud.frame = "rear";
        bag.messages.push_back({2, cloud.stamp_s, cloudMessage(cloud, kind)});
    }
    return bag;
}

std::string fault(const io::ScanSource& source) {
    try {
        io::openScans(source);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}
}  // namespace

TEST(MergedBag, PosesAreThoseOfTfStatic) {
    for (const Container& container : containers()) {
        BagContents bag = twoSensors(container.kind);
        bag.topics.push_back({"/tf_static", container.kind == Kind::kRos1
                                                ? "tf2_msgs/TFMessage"
                                                : "tf2_msgs/msg/TFMessage"});
        bag.messages.push_back(
            {3, kBegin_s,
             transformsMessage({{"front", {1, 0, 2}}, {"rear", {1, 3, 2}}}, container.kind)});
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, bag);
        const auto reader = io::openScans(file.string(), "all");
        EXPECT_EQ(reader->label(), "/points,/rear/points") << container.name;
        EXPECT_TRUE(reader->recording().warnings.empty()) << container.name;
        for (int i = 0; i < 4; ++i) {
            const auto scan = reader->next();
            ASSERT_TRUE(scan) << container.name;
            EXPECT_TRUE(scan->sensorPose.matrix().isIdentity());
            ASSERT_EQ(scan->points->size(), 10U);
            // Along the LiDARs' x axis, which is the vehicle's y axis, `rear` is 3 m ahead.
            EXPECT_NEAR(scan->points->getPointsBufferRef_x()[5], 13 + i, 1e-5);
            EXPECT_NEAR(scan->points->getPointsBufferRef_y()[6], 1, 1e-5);
        }
        EXPECT_FALSE(reader->next());
    }
}

TEST(MergedBag, WithoutPosesTheyAreAskedFor) {
    const test::TemporaryFolder folder;
    io::ScanSource source{(folder / "d.bag").string(), "all", "", ""};
    writeRos1Bag(source.path, twoSensors(Kind::kRos1));
    expectHolds(fault(source),
                {"/tf_static does not connect", "'/points'", "'/rear/points'", "--extrinsics"});
    source.extrinsicsFile = (folder / "poses.txt").string();
    test::writeText(source.extrinsicsFile, "/points 0 0 1 0 0 0\n/rear/points -3 0 1 180 0 0\n");
    const auto scan = io::openScans(source)->next();
    ASSERT_TRUE(scan);
    EXPECT_NEAR(scan->points->getPointsBufferRef_x()[5], -13, 1e-5);
}
}  // namespace delio::bag_test
