// How fast recordings are read, and in how much memory: benchmark_reading --work DIR [--from
// RECORDING] [--scans N] [RECORDING...]. The first scans of RECORDING (of a toy drive, where there
// is none), over and over, are written into DIR in every format that tests have a writer for, and
// read; RECORDINGs named at the end are read as they are.
#include <malloc.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>

#include "bag_writers.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/scan_reader.h"
#include "formats/bin_layouts.h"
#include "osf_writer.h"
#include "ouster_packets.h"
#include "spinning_packets.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using test::Floats;
namespace fs = std::filesystem;

/** A figure of /proc/self/status in MB. */
double megabytesOf(const std::string& name) {
    std::ifstream in("/proc/self/status");
    for (std::string line; std::getline(in, line);)
        if (line.rfind(name + ":", 0) == 0) return std::stod(line.substr(name.size() + 1)) / 1024;
    return 0;
}

/** In a process of its own, whose memory is nobody else's. */
void apart(const std::function<void()>& work) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        try {
            work();
        } catch (const std::exception& e) {
            std::cout << plainMessage(e) << '\n';
        }
        std::fflush(stdout);
        std::cout.flush();
        _exit(0);
    }
    waitpid(child, nullptr, 0);
}

void measure(const fs::path& recording, const std::string& label = "") {
    Stopwatch watch;
    const auto reader = io::openScans({recording.string(), label, "", ""});
    std::vector<double> memory_mb, each_ms;
    std::size_t points = 0;
    double sum_ms = watch.lap_ms();
    while (const auto scan = reader->next()) {
        const double ms = watch.lap_ms();
        sum_ms += ms;
        each_ms.push_back(ms);
        points += scan->points->size();
        memory_mb.push_back(megabytesOf("VmRSS"));
        watch.lap_ms();
    }
    const auto scans = memory_mb.size();
    if (scans == 0) throw Error("no scans in " + recording.string());
    std::sort(each_ms.begin(), each_ms.end());
    std::printf(
        "%-28s %6zu scans of %6zu points: %7.1f scans/s, median %6.1f ms, slowest %6.1f ms; "
        "memory %4.0f MB after a quarter, %4.0f MB at the end, most %4.0f MB\n",
        recording.filename().string().c_str(), scans, points / scans,
        1000 * static_cast<double>(scans) / sum_ms, each_ms[scans / 2], each_ms.back(),
        memory_mb[scans / 4], memory_mb.back(), megabytesOf("VmHWM"));
}

std::vector<Floats> firstScans(const std::string& recording) {
    constexpr std::size_t kMost = 10;
    if (recording.empty()) return test::toyScans(kMost);
    std::vector<Floats> scans;
    const auto reader = io::openScans({recording});
    while (scans.size() < kMost) {
        const auto scan = reader->next();
        if (!scan) break;
        scans.push_back(io::xyziOf(*scan->points));
    }
    if (scans.empty()) throw Error("'" + recording + "' contains no scans");
    return scans;
}

/** Writes the formats. */
class Sources {
 public:
    Sources(fs::path folder, std::vector<Floats> scans, std::size_t count)
        : folder_(std::move(folder)), scans_(std::move(scans)), count_(count) {}

    /** Each is gone when the next one is made. */
    void measureAll() const {
        rawlog("embedded.rawlog", true);
        rawlog("files.rawlog", false);
        clouds("kitti-bin", ".bin", "", false);
        clouds("pcd", ".pcd",
               "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
               "WIDTH %zu\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %zu\nDATA binary\n",
               false);
        clouds("ply", ".ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\n"
               "property float y\nproperty float z\nproperty float intensity\nend_header\n",
               false);
        clouds("txt", ".txt", "", true);
        for (const char* packed : {"none", "lz4", "bz2"})
            bag(std::string("ros1-") + packed + ".bag", test::WireWriter::Kind::kRos1,
                [&](const auto& file, const auto& contents) {
                    test::writeRos1Bag(file, contents, packed);
                });
        for (const char* packed : {"", "lz4", "zstd"})
            bag(std::string("ros2-") + (*packed ? packed : "none") + ".mcap",
                test::WireWriter::Kind::kCdr, [&](const auto& file, const auto& contents) {
                    test::writeMcap(file, contents, packed);
                });
        bag("ros2.db3", test::WireWriter::Kind::kCdr, test::writeDatabase);
        for (const io::BinLayout& layout : io::binLayouts())
            if (std::string(layout.name) != "kitti") records(layout);
        osf("png.osf", test::FieldCoding::kPng);
        osf("zpng.osf", test::FieldCoding::kZpng);
        packets("ot128.pcap");
    }

 private:
    const Floats& scan(std::size_t i) const { return scans_[i % scans_.size()]; }

    void rawlog(const std::string& name, bool embed) const {
        const fs::path file = folder_ / name;
        apart([&] {
            io::RawlogWriter writer(file.string(), "lidar", embed, true);
            for (std::size_t i = 0; i < count_; ++i)
                writer.add(0.1 * static_cast<double>(i), 1.6e9, scan(i));
            writer.finish({}, "", "", "");
        });
        measured(file);
        fs::remove_all(folder_ / (file.stem().string() + "_Images"));
    }

    /** A file each; `header` has the count of points once or twice. */
    void clouds(const std::string& name, const std::string& extension, const char* header,
                bool asText) const {
        const fs::path folder = folder_ / name;
        fs::create_directories(folder);
        for (std::size_t i = 0; i < count_; ++i) {
            const Floats& floats = scan(i);
            std::ofstream out(folder / (std::to_string(i) + extension), std::ios::binary);
            const std::size_t points = floats.size() / 4;
            char text[400];
            out.write(text, std::snprintf(text, sizeof(text), header, points, points));
            if (!asText)
                out.write(reinterpret_cast<const char*>(floats.data()),
                          static_cast<std::streamsize>(floats.size() * sizeof(float)));
            for (std::size_t k = 0; asText && k < floats.size(); ++k)
                out << floats[k] << (k % 4 == 3 ? '\n' : ' ');
        }
        measured(folder);
    }

    template <typename Write>
    void bag(const std::string& name, test::WireWriter::Kind kind, const Write& write) const {
        const fs::path file = folder_ / name;
        apart([&] {
            test::BagContents contents;
            contents.topics = {{"/points", kind == test::WireWriter::Kind::kRos1
                                               ? "sensor_msgs/PointCloud2"
                                               : "sensor_msgs/msg/PointCloud2"}};
            if (kind == test::WireWriter::Kind::kCdr) contents.encoding = "cdr";
            for (std::size_t i = 0; i < count_; ++i) {
                test::CloudSpec spec;
                spec.stamp_s = 1.6e9 + 0.1 * static_cast<double>(i);
                spec.xyzi = &scan(i);
                spec.columns = static_cast<std::uint32_t>(scan(i).size() / 4);
                contents.messages.push_back({0, spec.stamp_s, test::cloudMessage(spec, kind)});
            }
            write(file, contents);
        });
        measured(file);
    }

    /** The points as records of a layout, with 32 rings and times that rise; of MulRan's layout as
     *  many as its sensor has. */
    void records(const io::BinLayout& layout) const {
        const fs::path folder = folder_ / (std::string("bin-") + layout.name);
        fs::create_directories(folder);
        for (std::size_t i = 0; i < count_; ++i) {
            std::string bytes;
            constexpr std::size_t kMulran = 65536;
            const bool isMulran = std::string(layout.name) == "mulran";
            const std::size_t all = scan(i).size() / 4, points = isMulran ? kMulran : all;
            for (std::size_t k = 0; k < points; ++k)
                for (const io::Column& column : layout.columns)
                    bytes += number(column, &scan(i)[4 * (k % all)], k, points);
            std::ofstream(folder / (std::to_string(i) + ".bin"), std::ios::binary) << bytes;
        }
        measured(folder, layout.name);
    }

    static std::string number(const io::Column& column, const float* xyzi, std::size_t point,
                              std::size_t points) {
        const auto as = [&](double value) {
            std::string bytes(column.bytes, '\0');
            const auto real = static_cast<float>(value);
            const auto whole = static_cast<std::int64_t>(value);
            std::memcpy(bytes.data(), column.kind == 'F' ? static_cast<const void*>(&real) : &whole,
                        column.bytes);
            return bytes;
        };
        const double part = static_cast<double>(point) / static_cast<double>(points);
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (column.name == std::string(1, "xyz"[axis]))
                return as(column.kind == 'F' ? xyzi[axis] : 200 * (xyzi[axis] + 100.0));
        if (column.name == "ring" || column.name == "line")
            return as(static_cast<double>(point % 32));
        if (column.name == "t" || column.name.find("time") != column.name.npos)
            return as((column.kind == 'F' ? 0.1 : 1e8) * part);
        return as(xyzi[3]);
    }

    /** Turns of 128 rows and 1024 columns. */
    void osf(const std::string& name, test::FieldCoding coding) const {
        const fs::path file = folder_ / name;
        apart([&] {
            constexpr std::size_t kRows = 128, kColumns = 1024;
            auto json = test::OusterToy().json();
            json["beam_altitude_angles"] = json["beam_azimuth_angles"] =
                std::vector<double>(kRows, 1.5);
            json["data_format"]["pixels_per_column"] = kRows;
            json["data_format"]["columns_per_frame"] = kColumns;
            json["data_format"]["pixel_shift_by_row"] = std::vector<int>(kRows, 12);
            const auto info = io::readOusterInfo(json.dump(), "toy");
            test::OsfSensor sensor{json.dump(), {}};
            std::mt19937 random(1);
            for (std::size_t i = 0; i < count_; ++i) {
                io::OusterFrame frame(info);
                frame.number = static_cast<std::uint16_t>(i);
                frame.count = kColumns;
                for (std::size_t k = 0; k < kRows * kColumns; ++k) {
                    frame.ranges_mm[k] =
                        static_cast<std::uint32_t>(5000 + k % kRows * 200 + random() % 30);
                    frame.reflectivities[k] = static_cast<std::uint8_t>(random() % 60);
                }
                for (std::size_t c = 0; c < kColumns; ++c) {
                    frame.received[c] = true;
                    frame.times_ns[c] = (i * kColumns + c + 1) * 97656;
                }
                sensor.turns.push_back(test::osfTurn(info, frame, coding, 1'600'000'000ULL << 30));
            }
            std::ofstream(file, std::ios::binary) << test::osfFile({sensor});
        });
        measured(file);
    }

    /** Turns of an OT128 in high resolution, 460 800 points each. */
    void packets(const std::string& name) const {
        const fs::path file = folder_ / name;
        apart([&] {
            test::HesaiToy toy = test::hesai128Toy(true);
            toy.state = 0;
            toy.step = 10;
            toy.next_us = 27.778;
            test::PcapWriter pcap;
            for (const auto& packet :
                 test::hesaiDrive(toy, std::min(100.0, static_cast<double>(count_))))
                pcap.add(packet.bytes, packet.time_s);
            pcap.write(file.string());
        });
        measured(file);
    }

    static void measured(const fs::path& recording, const std::string& label = "") {
        apart([&] { measure(recording, label); });
        fs::remove_all(recording);
    }

    fs::path folder_;
    std::vector<Floats> scans_;
    std::size_t count_;
};
}  // namespace

int main(int argc, char** argv) {
    // As delio-slam keeps memory for the next scan.
    mallopt(M_MMAP_THRESHOLD, 8 << 20);
    mallopt(M_TRIM_THRESHOLD, 384 << 20);
    try {
        TCLAP::CmdLine cmd("Measures how fast recordings are read");
        TCLAP::ValueArg<std::string> work("", "work", "Folder to write recordings into", false, "",
                                          "DIR", cmd);
        TCLAP::ValueArg<std::string> from("", "from", "Recording whose scans are written", false,
                                          "", "RECORDING", cmd);
        TCLAP::ValueArg<unsigned> count("", "scans", "Scans in each", false, 400, "N", cmd);
        TCLAP::UnlabeledMultiArg<std::string> given("recordings", "Recordings to read", false,
                                                    "RECORDING", cmd);
        cmd.parse(argc, argv);
        for (const auto& recording : given.getValue()) apart([&] { measure(recording); });
        if (!work.isSet()) return 0;
        fs::create_directories(work.getValue());
        Sources(work.getValue(), firstScans(from.getValue()), count.getValue()).measureAll();
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "benchmark_reading: " << plainMessage(e) << '\n';
        return 1;
    }
}
