#include "delio/formats/drive_meta.h"

#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include "delio/core/error.h"
#include "test_data.h"

namespace {
using namespace delio;

TEST(DriveMeta, ComesBackAsItWasWritten) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "a.b.rawlog";
    EXPECT_FALSE(io::readDriveMeta(rawlog));
    for (const std::string text :
         {"HDL-64E", "a: b # c", "#", "yes", "1e3", "it's \"quoted\"", "- dash", " spaces ", "~",
          "", "[x", "{y", "back\\slash", "two\nlines", "100%", "@home", "&anchor", "*", "!tag"}) {
        io::DriveMeta meta;
        meta.sensorModel = text;
        meta.source = "kitti-raw";
        meta.motionCompensated = false;
        meta.verticalCorrectionDeg = 0.205;
        meta.epoch_s = 1317042145.951199;
        meta.generator = text;
        test::writeText(io::sidecarPath(rawlog, ".meta.yaml"), io::textOf(meta));
        ASSERT_TRUE(std::filesystem::exists(folder / "a.b.meta.yaml"));
        const auto back = io::readDriveMeta(rawlog);
        ASSERT_TRUE(back);
        EXPECT_EQ(back->sensorModel, text);
        EXPECT_EQ(back->source, "kitti-raw");
        EXPECT_FALSE(back->motionCompensated);
        EXPECT_EQ(back->verticalCorrectionDeg, 0.205);
        EXPECT_EQ(back->epoch_s, 1317042145.951199);
        EXPECT_EQ(back->generator, text);
        if (text.empty()) continue;  // which MRPT's reader refuses
        const auto yaml = mrpt::containers::yaml::FromFile(folder / "a.b.meta.yaml");
        EXPECT_EQ(yaml["sensor_model"].as<std::string>(), text) << "it is YAML to others, too";
    }
}

TEST(DriveMeta, WhatIsNotSaidIsTheDefaultAndWhatIsNotUnderstoodAnError) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "a.rawlog";
    test::writeText(folder / "a.meta.yaml", "# only a comment and\nsensor_model: VLP-16 # this\n");
    const auto meta = io::readDriveMeta(rawlog);
    ASSERT_TRUE(meta);
    EXPECT_EQ(meta->sensorModel, "VLP-16");
    EXPECT_TRUE(meta->motionCompensated);
    EXPECT_EQ(meta->epoch_s, 0);
    test::writeText(folder / "a.meta.yaml",
                    "---\r\nsource: 'it''s # a: b'  # so\r\ngenerator:\r\n");
    EXPECT_EQ(io::readDriveMeta(rawlog)->source, "it's # a: b");
    EXPECT_EQ(io::readDriveMeta(rawlog)->generator, "");
    for (const std::string text :
         {"sensor_modell: x", "vertical_correction_deg: 6", "vertical_correction_deg: .nan",
          "vertical_correction_deg: much", "vertical_correction_deg: 0.2x", "epoch_unix_s: -1",
          "epoch_unix_s: later", "motion_compensated: perhaps", "just words", "[1, 2]",
          "{a: ", "sensor_model: {a: b}", "sensor_model: \"open", "source: 'it' is",
          "source: a\nsource: b", ""}) {
        test::writeText(folder / "a.meta.yaml", text);
        try {
            io::readDriveMeta(rawlog);
            ADD_FAILURE() << "parse: " << text;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("a.meta.yaml"), std::string::npos) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        }
    }
}
}  // namespace
