// .pcd files as scans.
#include "formats/pcd.h"

#include <liblzf/lzf.h>

#include <cmath>

#include "cloud_files.h"

namespace {
using namespace delio;
using namespace delio::cloud_test;

/** Fields of a header, and its data. */
struct Pcd {
    std::string fields = "x y z intensity", sizes = "4 4 4 4", types = "F F F F",
                counts = "1 1 1 1", width = "5", height = "1", points = "5", data = "binary",
                bytes = rawPoints(pointsOf(3));

    std::string text() const {
        return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields +
               "\nSIZE " + sizes + "\nTYPE " + types + "\nCOUNT " + counts + "\nWIDTH " + width +
               "\nHEIGHT " + height + "\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS " + points + "\nDATA " +
               data + "\n" + bytes;
    }
};

/** As binary_compressed has it: `byField`, compressed. */
std::string compressed(const std::string& byField) {
    std::string packed(byField.size() + 1000, '\0');
    const auto size = lzf_compress(byField.data(), static_cast<unsigned>(byField.size()),
                                   packed.data(), static_cast<unsigned>(packed.size()));
    return raw(std::uint32_t{size}, static_cast<std::uint32_t>(byField.size())) +
           packed.substr(0, size);
}

class PcdScan : public testing::Test {
 protected:
    io::CloudRecords read(const Pcd& pcd) const { return read(pcd.text()); }
    io::CloudRecords read(const std::string& text) const {
        test::writeText(file_, text);
        return io::readPcdScan(file_.string());
    }
    void refused(const Pcd& pcd, const std::vector<std::string>& words) const {
        refused(pcd.text(), words);
    }
    void refused(const std::string& text, const std::vector<std::string>& words) const {
        const auto error = errorOf([&] { read(text); });
        expectError(error, {file_.string()});
        expectError(error, words);
    }

    test::TemporaryFolder folder_;
    const fs::path file_ = folder_ / "a.pcd";
};

TEST_F(PcdScan, Binary) {
    const Scan scan = scanOf(read(Pcd()));
    EXPECT_EQ(pointsOf(scan), pointsOf(3));
    EXPECT_TRUE(scan.rings.empty());
}

TEST_F(PcdScan, Ascii) {
    Pcd pcd;
    pcd.data = "ascii";
    pcd.bytes = "1 2 3 0.5\n-1e2 +2 nan .25\r\n\n1 1 1 1\n2\t2 2 2\n3 3 3 3";
    const auto points = pointsOf(scanOf(read(pcd)));
    ASSERT_EQ(points.size(), 5U);
    EXPECT_EQ(points[0], (Xyzi{1, 2, 3, 0.5F}));
    EXPECT_EQ(points[1][0], -100);
    EXPECT_TRUE(std::isnan(points[1][2]));
    EXPECT_EQ(points[4], (Xyzi{3, 3, 3, 3}));
}

TEST_F(PcdScan, Compressed) {
    const auto points = pointsOf(3, 500);
    std::string byField;
    for (std::size_t k = 0; k < 4; ++k)
        for (const auto& p : points) byField += raw(p[k]);
    Pcd pcd;
    pcd.width = pcd.points = "500";
    pcd.data = "binary_compressed";
    pcd.bytes = compressed(byField);
    ASSERT_LT(pcd.bytes.size(), byField.size());
    EXPECT_EQ(pointsOf(scanOf(read(pcd))), points);

    auto damaged = pcd;
    damaged.points = damaged.width = "501";
    refused(damaged, {"501 points"});
    damaged = pcd;
    damaged.bytes.resize(damaged.bytes.size() - 1);
    refused(damaged, {"cut off"});
    damaged = pcd;
    damaged.bytes.resize(6);
    refused(damaged, {"cut off"});
    damaged = pcd;
    damaged.bytes.replace(8, 40, std::string(40, '\xFF'));
    refused(damaged, {"damaged"});
    damaged.bytes = raw(std::uint32_t{4}, std::uint32_t{4000000000}) + "1234";
    damaged.points = damaged.width = "250000000";
    refused(damaged, {"250000000"});
}

// Other fields, several numbers a field, numbers that a layout has no kind for; in both layouts.
TEST_F(PcdScan, OddFields) {
    Pcd pcd;
    pcd.fields = "normal _ y ring x time z";
    pcd.sizes = "4 1 8 2 4 8 4";
    pcd.types = "F U F U F U F";
    pcd.counts = "3 2 1 1 1 1 1";
    pcd.width = pcd.points = "2";
    const auto point = [](float x) {
        return raw(Xyzi{9, 9, 9, 9}).substr(0, 12) + "ab" + raw(2.5 * x, std::uint16_t{7}, x) +
               raw(static_cast<std::uint64_t>(x), x + 0.5F);
    };
    pcd.bytes = point(1) + point(2);
    const auto check = [&](const Pcd& file) {
        const Scan scan = scanOf(read(file));
        ASSERT_EQ(scan.points->size(), 2U);
        EXPECT_EQ(scan.points->getPointsBufferRef_x()[1], 2);
        EXPECT_EQ(scan.points->getPointsBufferRef_y()[1], 5);
        EXPECT_EQ(scan.points->getPointsBufferRef_z()[1], 2.5);
        EXPECT_EQ(scan.rings, (std::vector<std::uint16_t>{7, 7}));
        for (const auto& field : read(file).layout.fields)
            EXPECT_EQ(field.kind == io::NumberKind::kFloat64,
                      field.name == "time" || field.name == "y");
    };
    check(pcd);
    std::string byField;
    std::size_t at = 0;
    for (const std::size_t bytes : {12U, 2U, 8U, 2U, 4U, 8U, 4U}) {
        for (const float x : {1.0F, 2.0F}) byField += point(x).substr(at, bytes);
        at += bytes;
    }
    pcd.data = "binary_compressed";
    pcd.bytes = compressed(byField);
    check(pcd);
}

TEST_F(PcdScan, RowsOfAnOrganisedCloudAreRings) {
    Pcd pcd;
    pcd.width = "3";
    pcd.height = "2";
    pcd.points = "6";
    pcd.bytes = rawPoints(pointsOf(1, 6));
    EXPECT_EQ(read(pcd).rows, 2U);
    EXPECT_EQ(scanOf(read(pcd)).rings, (std::vector<std::uint16_t>{0, 0, 0, 1, 1, 1}));
}

// As some programs write a cloud whose size they do not know yet.
TEST_F(PcdScan, WidthAndHeightOfZero) {
    std::string byField;
    for (std::size_t k = 0; k < 4; ++k)
        for (const auto& p : pointsOf(3, 500)) byField += raw(p[k]);
    std::string lines;
    for (int i = 0; i < 500; ++i) lines += "1 2 3 4\n";
    for (const auto& [data, bytes] :
         {std::pair<const char*, std::string>{"binary", rawPoints(pointsOf(3, 500))},
          {"binary_compressed", compressed(byField)},
          {"ascii", lines}})
        for (const char* points : {"POINTS 500\n", "POINTS 0\n", ""}) {
            Pcd pcd;
            pcd.width = pcd.height = "0";
            pcd.data = data;
            pcd.bytes = bytes;
            std::string text = pcd.text();
            const std::string said = "POINTS 5\n";
            text.replace(text.find(said), said.size(), points);
            EXPECT_EQ(scanOf(read(text)).points->size(), 500U) << data << " " << points;
        }
    Pcd none;
    none.width = none.points = "0";
    none.bytes = "";
    EXPECT_EQ(scanOf(read(none)).points->size(), 0U);
}

// As Livox's recorder writes numbers of a byte: a line end and a space may be among them.
TEST_F(PcdScan, RawCharactersInAscii) {
    Pcd pcd;
    pcd.fields = "x y z intensity tag ring";
    pcd.sizes = "4 4 4 4 1 1";
    pcd.types = "F F F F U U";
    pcd.counts = "1 1 1 1 1 1";
    pcd.data = "ascii";
    pcd.bytes.clear();
    const std::string lines("\x00\x01\n \x05", 5);
    for (const char line : lines) pcd.bytes += std::string("1.5 2 -3 4 \x10 ") + line + "\n";
    const Scan scan = scanOf(read(pcd));
    EXPECT_EQ(scan.points->getPointsBufferRef_z()[4], -3);
    EXPECT_EQ(scan.rings, (std::vector<std::uint16_t>{0, 1, 10, 32, 5}));
    Pcd livox = pcd;
    livox.fields = "x y z intensity tag line";  // the laser, which is no ring
    EXPECT_TRUE(scanOf(read(livox)).rings.empty());
    pcd.bytes.resize(pcd.bytes.size() - 12);
    refused(pcd, {"after 4 of 5"});
    pcd.bytes = "1 2 3 4 16 5\n1 2 3 4 16 6\n1 2 3 4 0 7\n1 2 3 4 0 8\n1 2 3 4 0 9";
    EXPECT_EQ(scanOf(read(pcd)).rings.back(), 9);
}

TEST_F(PcdScan, RefusesLyingHeaders) {
    const auto with = [](std::string Pcd::*member, const std::string& value) {
        Pcd pcd;
        pcd.*member = value;
        return pcd;
    };
    refused(with(&Pcd::width, "4"), {"5 points", "4 by 1"});
    refused(with(&Pcd::points, "-5"), {"POINTS", "number of points"});
    refused(with(&Pcd::sizes, "4 4 4"), {"different lengths"});
    refused(with(&Pcd::sizes, "4 4 4 3"), {"intensity"});
    refused(with(&Pcd::types, "F F F Q"), {"intensity"});
    refused(with(&Pcd::data, "zip"), {"'zip'"});
    refused(with(&Pcd::bytes, rawPoints(pointsOf(1, 4)) + "123456789012345"), {"4 of 5"});
    for (const char* data : {"ascii", "binary", "binary_compressed"}) {
        Pcd pcd;
        pcd.data = data;
        pcd.points = pcd.width = "1000000000000";
        refused(pcd, {"1000000000000"});
        pcd.points = pcd.width = "18446744073709551615";
        refused(pcd, {"18446744073709551615"});
        pcd.height = "4";
        refused(pcd, {"by 4"});
        pcd.counts = "0 0 0 0";
        pcd.height = "1";
        refused(pcd, {});
    }
}

TEST_F(PcdScan, RefusesWhatIsNoPcd) {
    refused(std::string(), {"empty"});
    refused(std::string("ply\n"), {"header"});
    refused(Pcd().text().substr(0, 100), {"header"});
    Pcd pcd;
    pcd.data = "ascii";
    pcd.bytes = "1 2 3 4\n1 2 3 4\n1 2 x 4\n1 2 3 4\n1 2 3 4\n";
    refused(pcd, {"after 2 of 5"});
    pcd.bytes = "1 2 3 4.000\n1 2 3\n1 2 3 4\n1 2 3 4\n1 2 3 4\n";
    refused(pcd, {"after 1 of 5"});
    expectError(errorOf([&] { io::readPcdScan((folder_ / "none.pcd").string()); }), {"none.pcd"});
}
}  // namespace
