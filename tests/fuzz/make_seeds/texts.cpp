#include <sstream>

#include "delio/formats/drive_meta.h"
#include "delio/formats/g2o.h"
#include "delio/formats/georeference.h"
#include "delio/formats/scan_table.h"
#include "delio/run/summary.h"
#include "delio/slam/options.h"
#include "run/tables.h"
#include "seeds.h"

namespace delio::fuzz {
namespace {
void texts() {
    io::saveG2o(smallGraph(), seed("g2o", "graph").string());
    const std::string row = "1 0 0 0 0 1 0 0 0 0 1 0\n", tum = "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n";
    writeText(seed("poses", "kitti"), "0" + row + "1 0 0 2 0 1 0 0 0 0 1 0\n");
    writeText(seed("fixes", "csv"), "0time,lat,lon,height,sigma_east\n1616513421.5,49,8,1,2\n");
    writeText(seed("fixes", "nmea"),
              "1$GPGGA,123519.5,4807.038,N,01131.0,E,4,08,0.9,545.4,M,46.9,M,,\n"
              "$GNRMC,123520,A,4807.038,N,01131.000,E,,,230394,,\n$GPZDA,1,2,3,2024,,\n");
    behind("2", seed("fixes", "georeference"),
           [](const fs::path& file) { io::writeGeoreference({}, {}, file.string()); });
    writeText(seed("poses", "tum"), "0# t x y z\n" + tum);
    writeText(seed("poses", "times"), "10\n0.1\n2e-1\n");
    writeText(seed("poses", "calib"), "2P0: " + row + "Tr: " + row);
    writeText(seed("poses", "meta"),
              "3source: synthetic\nmotion_compensated: true\nvertical_correction_deg: 0\n");
    writeText(seed("poses", "compared"), "4" + row + row + kNul + row + row);
    writeText(seed("poses", "compared_tum"), "4" + tum + kNul + tum);
    writeText(seed("kitti", "calib"), "0Tr: " + row);
    writeText(seed("kitti", "times"), "10\n0.1\n");
    writeText(seed("kitti", "poses"), "2" + row + row);
    writeText(seed("kitti", "scan"), "3" + std::string(48, 'A'));
    writeText(seed("kitti", "velo"), "4R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
    writeText(seed("kitti", "cam"), "5R_rect_00: 1 0 0 0 1 0 0 0 1\n");
    writeText(seed("kitti", "imu"), "6R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
    writeText(seed("kitti", "stamps"), "72011-09-26 13:02:25.951199337\n");
    writeText(seed("kitti", "oxts"), "849 8 110 0 0 0 0 0\n");
    for (const auto& name : Options::profileNames())
        writeText(seed("options", name), "0" + readText(test::profileFolder() / (name + ".ini")));
    std::ostringstream all;
    Options().write(all);
    writeText(seed("options", "all"), "0" + all.str());
    writeText(seed("options", "words"),
              "1scan.max_range=80\nodometry.method=paper\nmap.voxel=0.2\ngraph.window=2\n");
}

void tables() {
    io::ScanRow row;
    row.values = {{"points", "12"}};
    behind("0", seed("tables", "scans"), [&](const fs::path& file) {
        io::writeScanTable(
            1, [&](std::size_t) { return row; }, file.string());
    });
    behind("1", seed("tables", "loops"), [](const fs::path& file) {
        run::writeLoopTable({places::LoopCandidate{}}, file.string());
    });
    behind("2", seed("tables", "localisation"), [](const fs::path& file) {
        std::vector<run::RunRow> rows;
        rows.push_back({});
        run::writeLocalisationTable(rows, {MapFix{}}, file.string());
    });
    run::Summary summary;
    summary.version = "0.1.0";
    summary.ms_per_scan_of_stages = {{"scan", 1}};
    summary.warnings = {"a warning"};
    summary.metrics = {{"t_percent", 1}};
    behind("3", seed("tables", "summary"),
           [&](const fs::path& file) { run::writeSummary(summary, file.string()); });
}
}  // namespace

void seedTexts() {
    texts();
    tables();
}
}  // namespace delio::fuzz
