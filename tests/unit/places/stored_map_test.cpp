#include "delio/places/stored_map.h"

#include <gtest/gtest.h>

#include <fstream>

#include "delio/core/error.h"
#include "town_map.h"

namespace {
using namespace delio;
using namespace delio::localisation_test;

class StoredMapFile : public testing::Test {
 protected:
    void SetUp() override { StoredMap::save(drive_.content, path_); }

    /** What is said of a file with this content, of whatever part is damaged. */
    std::string faultOf(const std::string& bytes) const {
        const std::string file = fileIn(folder_, "damaged.delio");
        test::writeText(file, bytes);
        try {
            const StoredMap map(file);
            for (std::size_t i = 0; i < map.submaps().size(); ++i) {
                map.descriptor(i);
                map.points(i);
            }
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("damaged.delio"), std::string::npos) << e.what();
            return e.what();
        }
        return "";
    }

    test::TemporaryFolder folder_;
    TownDrive drive_{roundTheBlock(15)};
    const std::string path_ = fileIn(folder_);
};

TEST_F(StoredMapFile, GivesBackWhatItWasMadeOf) {
    const StoredMap map(path_);
    const auto& made = drive_.content;
    ASSERT_EQ(map.graph().poses().size(), made.graph.poses().size());
    for (std::size_t i = 0; i < map.graph().poses().size(); ++i)
        EXPECT_EQ(map.graph().poses()[i].matrix(), made.graph.poses()[i].matrix());
    ASSERT_EQ(map.graph().edges().size(), made.graph.edges().size());
    for (std::size_t i = 0; i < map.graph().edges().size(); ++i) {
        const auto &edge = map.graph().edges()[i], &wanted = made.graph.edges()[i];
        EXPECT_EQ(edge.from, wanted.from);
        EXPECT_EQ(edge.to, wanted.to);
        EXPECT_EQ(edge.increment.pose.matrix(), wanted.increment.pose.matrix());
        EXPECT_EQ(edge.increment.covariance, wanted.increment.covariance);
    }
    ASSERT_EQ(map.drives().size(), 1U);
    EXPECT_EQ(map.drives()[0].name, "town");
    EXPECT_EQ(map.drives()[0].stamps_s, made.drives[0].stamps_s);
    EXPECT_EQ(map.trajectory(map.drives()[0]).poses.size(), made.graph.poses().size());
    ASSERT_EQ(map.submaps().size(), made.submaps.size());
    for (std::size_t i = 0; i < map.submaps().size(); ++i) {
        const auto &submap = map.submaps()[i], &wanted = made.submaps[i];
        EXPECT_EQ(submap.first, wanted.first);
        EXPECT_EQ(submap.key, wanted.key);
        EXPECT_EQ(submap.last, wanted.last);
        EXPECT_EQ(submap.level, wanted.level);
        EXPECT_EQ(submap.driven.path_m, wanted.driven.path_m);
        EXPECT_EQ(submap.driven.variance_m2, wanted.driven.variance_m2);
        EXPECT_EQ(submap.driven.variance_rad2, wanted.driven.variance_rad2);
    }
}

// In another order, to 5 mm.
TEST_F(StoredMapFile, KeepsEveryPoint) {
    const StoredMap map(path_);
    for (std::size_t i = 0; i < map.submaps().size(); ++i) {
        const auto wanted = drive_.content.points(i), points = map.points(i);
        ASSERT_EQ(points.cols(), wanted.cols());
        EXPECT_LT((points.rowwise().mean() - wanted.rowwise().mean()).norm(), 0.001);
        for (Eigen::Index k = 0; k < wanted.cols(); k += 97)
            EXPECT_LE((points.colwise() - wanted.col(k)).cwiseAbs().colwise().maxCoeff().minCoeff(),
                      0.00251F)
                << k;
    }
}

TEST_F(StoredMapFile, KeepsWhatPlacesAreFoundBy) {
    const StoredMap map(path_);
    for (std::size_t i = 0; i < map.submaps().size(); ++i) {
        const auto descriptor = map.descriptor(i), wanted = drive_.content.descriptor(i);
        EXPECT_LT((descriptor.walls.weights() - wanted.walls.weights()).norm(), 1e-5);
        EXPECT_EQ(descriptor.image.cells(), wanted.image.cells());
        EXPECT_EQ(descriptor.image.bands(), wanted.image.bands());
        EXPECT_EQ(descriptor.image.grounds(), wanted.image.grounds());
        EXPECT_EQ(descriptor.image.heights(), wanted.image.heights());
        const auto& cells = wanted.image.grounds();
        for (Eigen::Index k = 0; k < cells.cols(); ++k)
            EXPECT_EQ(descriptor.image.groundAt(cells(0, k), cells(1, k)),
                      wanted.image.groundAt(cells(0, k), cells(1, k)));
    }
}

TEST_F(StoredMapFile, WrittenOnceMoreItIsTheSame) {
    const std::string again = fileIn(folder_, "again.delio");
    {
        const StoredMap map(path_);
        StoredMap::save(map.content(), again);
    }
    EXPECT_TRUE(test::readText(path_) == test::readText(again));
}

// Read on while it is replaced.
TEST_F(StoredMapFile, StaysWhatItWasWhenItIsOpened) {
    const StoredMap map(path_);
    const auto points = map.points(0);
    StoredMap::save({}, path_);
    EXPECT_EQ(map.points(0), points);
    EXPECT_TRUE(StoredMap(path_).submaps().empty());
}

TEST_F(StoredMapFile, WhateverIsCutOffIsSaid) {
    const std::string whole = test::readText(path_);
    EXPECT_EQ(faultOf(whole), "");
    for (const double share : {0.0, 0.3, 0.9, 0.9999}) {
        const auto bytes = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
        EXPECT_NE(faultOf(whole.substr(0, bytes)), "") << share;
    }
    EXPECT_NE(faultOf(whole.substr(0, 20)).find("not a stored map"), std::string::npos);
}

TEST_F(StoredMapFile, WhateverIsTurnedIsSaid) {
    const std::string whole = test::readText(path_);
    for (std::size_t i = 0; i < whole.size(); i += i < 60 ? 1 : whole.size() / 60) {
        std::string bytes = whole;
        bytes[i] = static_cast<char>(bytes[i] ^ 0x10);
        EXPECT_NE(faultOf(bytes), "") << i;
    }
}

TEST_F(StoredMapFile, PosesThatAreNoneAreSaid) {
    MapContent content = drive_.content;
    content.submaps.front().level(0, 0) = NAN;
    StoredMap::save(content, path_);
    EXPECT_NE(faultOf(test::readText(path_)).find("invalid index"), std::string::npos);
}

// Results are written into files and folders of these names.
TEST_F(StoredMapFile, NamesThatLeadOutOfAFolderAreSaid) {
    MapContent content = drive_.content;
    for (const std::string& name :
         {std::string(), std::string("."), std::string(".."), std::string("../town"),
          std::string("/town"), std::string("a/town"), std::string("town\n"),
          std::string("\x1B[2J"), std::string(1, '\0')}) {
        content.drives.front().name = name;
        StoredMap::save(content, path_);
        EXPECT_NE(faultOf(test::readText(path_)), "") << name;
    }
    content.drives.front().name = "..town, gr\xC3\xBCn";
    StoredMap::save(content, path_);
    EXPECT_EQ(faultOf(test::readText(path_)), "");
}

TEST_F(StoredMapFile, NumbersThatAreNoneAreSaid) {
    MapContent content = drive_.content;
    content.drives.front().stamps_s[1] = NAN;
    StoredMap::save(content, path_);
    EXPECT_NE(faultOf(test::readText(path_)).find("invalid index"), std::string::npos);
    content = drive_.content;
    content.submaps.front().driven.path_m = INFINITY;
    StoredMap::save(content, path_);
    EXPECT_NE(faultOf(test::readText(path_)), "");
}

TEST_F(StoredMapFile, AnotherVersionIsNamed) {
    std::string bytes = test::readText(path_);
    bytes[8] = 7;
    EXPECT_NE(faultOf(bytes).find("version 7"), std::string::npos);
}

TEST_F(StoredMapFile, OtherFilesAndNoneAreRefused) {
    EXPECT_NE(faultOf(std::string(5000, 'x')).find("not a stored map"), std::string::npos);
    EXPECT_THROW(StoredMap(fileIn(folder_, "none.delio")), Error);
    EXPECT_THROW(StoredMap(folder_.path().string()), Error);
}

TEST_F(StoredMapFile, IsNotLeftHalfWritten) {
    const std::string before = test::readText(path_);
    auto content = drive_.content;
    content.points = [](std::size_t) -> Eigen::Matrix3Xf { throw Error("no more"); };
    EXPECT_THROW(StoredMap::save(content, path_), Error);
    EXPECT_TRUE(test::readText(path_) == before);
}
}  // namespace
