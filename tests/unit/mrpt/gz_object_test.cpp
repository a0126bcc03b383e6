// Files of one MRPT object (libdelio/src/mrpt/object_file.h), by the simplemaps that are written
// so.
#include <gtest/gtest.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "delio/map/simplemap.h"
#include "rawlog_files.h"

namespace {
using namespace delio;

class GzObject : public ::testing::Test {
 protected:
    void SetUp() override {
        const auto frame = mrpt::obs::CSensoryFrame::Create();
        frame->insert(rawlog_test::cloudObservation(7));
        const auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
        map_->insert(pose, frame);
        map::saveSimplemap(*map_, path_);
        whole_ = test::readText(path_);
    }

    /** Of a file with these bytes; empty where it is read, and then it is what was written. */
    std::string faultOf(const std::string& bytes) {
        test::writeText(path_, bytes);
        try {
            const auto points = map::pointsOf(map::loadSimplemap(path_));
            EXPECT_EQ(points.getPointsBufferRef_x(), map::pointsOf(*map_).getPointsBufferRef_x());
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }

    const test::TemporaryFolder folder_;
    const std::string path_ = folder_ / "a.simplemap";
    const mrpt::maps::CSimpleMap::Ptr map_ = mrpt::maps::CSimpleMap::Create();
    std::string whole_;
};

TEST_F(GzObject, IsReadCompressedOrPlain) {
    EXPECT_EQ(faultOf(whole_), "");
    rawlog_test::writeRawlog(path_, {map_});
    const std::string plain = test::readText(path_);
    EXPECT_EQ(faultOf(plain), "");
    EXPECT_NE(faultOf(plain + "x"), "") << "it holds more";
    EXPECT_NE(faultOf(plain.substr(0, plain.size() - 1)), "");
}

/** A turned bit of a number still unpacks: only the checksum tells. (Of two places that hold the
 *  same bytes gzip may name either: that is no damage.) */
TEST_F(GzObject, DamageAndCutsShow) {
    std::size_t harmless = 0;
    for (std::size_t i = 10; i < whole_.size(); ++i) {
        std::string damaged = whole_;
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        for (const auto& bytes : {damaged, whole_.substr(0, i)}) {
            const std::string fault = faultOf(bytes);
            if (fault.empty() && bytes.size() == whole_.size()) {
                ++harmless;
                continue;
            }
            EXPECT_NE(fault.find("is not a .simplemap, or it is cut off"), std::string::npos)
                << "byte " << i << ": " << fault;
            EXPECT_EQ(fault.find('\n'), std::string::npos);
        }
    }
    EXPECT_LT(harmless, whole_.size() / 20);
}

TEST_F(GzObject, WhatIsNotThereOrSomethingElseIsNamed) {
    EXPECT_NE(faultOf("this is a letter\n").find("is not a .simplemap"), std::string::npos);
    EXPECT_NE(faultOf("").find("is not a .simplemap"), std::string::npos);
    for (const std::string path : {folder_ / "none.simplemap", folder_.path()}) try {
            map::loadSimplemap(path);
            ADD_FAILURE() << path;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("there is no such file"), std::string::npos);
        }
}
}  // namespace
