#include "run/tables.h"

#include <gtest/gtest.h>

#include "delio/core/error.h"
#include "delio/run/doubts.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;

std::vector<MapFix> someFixes() {
    std::vector<MapFix> fixes(12);
    for (std::size_t i = 2; i < 6; ++i) {
        fixes[i].where = Whereabouts::kInMap;
        fixes[i].measured = i != 4;
        fixes[i].vehicle = {test::poseAtDeg(1.5, -2, 0.25, 90), 0.25 * Matrix6::Identity()};
    }
    for (std::size_t i = 6; i < 12; ++i) {
        fixes[i].where = Whereabouts::kOutside;
        fixes[i].reason = "no map points here";
    }
    return fixes;
}

std::vector<run::RunRow> someRows() {
    std::vector<run::RunRow> rows;
    for (std::size_t i = 0; i < 12; ++i) {
        run::RunRow row;
        row.scan = 100 + 2 * i;
        row.stamp_s = 0.5 * static_cast<double>(i);
        rows.push_back(row);
    }
    return rows;
}

TEST(LocalisationTable, ComesBackAsItWasWritten) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "localisation.csv";
    run::writeLocalisationTable(someRows(), someFixes(), path);
    const auto read = run::readLocalisationTable(path);
    ASSERT_EQ(read.size(), 12U);
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].scan, 100 + 2 * i);
        EXPECT_EQ(read[i].where, someFixes()[i].where);
        EXPECT_EQ(read[i].measured, someFixes()[i].measured);
    }
    const std::string text = test::readText(path);
    EXPECT_NE(text.find("\n104,1.0000000,in_map,1,0,0.000,1.5,-2,0.25,0,0,0.707106781,0.707106781,"
                        "0.25,0,0,0,0,0,0.25,"),
              std::string::npos)
        << text;
    // Where nothing is known no numbers are.
    EXPECT_NE(text.find("\n100,0.0000000,unknown,0,0,0.000,,,,,,,,,"), std::string::npos) << text;
    EXPECT_NE(text.find(",no map points here\n"), std::string::npos);
}

TEST(LocalisationTable, WhatIsNoneIsRefused) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "localisation.csv";
    for (const std::string text : {"", "scan,where\n1,in_map\n", "scan,where,measured\n1,lost,1\n",
                                   "scan,where,measured\nx,in_map,1\n"}) {
        test::writeText(path, text);
        EXPECT_THROW(run::readLocalisationTable(path), Error) << text;
    }
    EXPECT_THROW(run::readLocalisationTable(folder / "none.csv"), Error);
}

TEST(LocalisationDoubts, StretchesOutsideTheMapAreNamed) {
    const auto warnings = run::warningsOf(someFixes(), someRows());
    ASSERT_EQ(warnings.size(), 1U);  // two scans before it was found are none
    EXPECT_NE(warnings[0].find("scans 112 to 122 are outside the stored map"), std::string::npos)
        << warnings[0];
    std::vector<MapFix> late(12);
    late.back() = someFixes()[3];
    EXPECT_NE(run::warningsOf(late, someRows()).at(0).find("scans 100 to 120 were not localised"),
              std::string::npos);
}
}  // namespace
