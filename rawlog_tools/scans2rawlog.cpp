// scans2rawlog: any recording that delio-slam reads as an MRPT rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/scan_reader.h"
#include "delio/version.h"
#include "overlap.h"

namespace {
using namespace delio;

using Text = TCLAP::ValueArg<std::string>;
using Number = TCLAP::ValueArg<cli::Count>;

struct Arguments {
    TCLAP::CmdLine cmd{"converts a LiDAR recording to an MRPT rawlog with side files", ' ',
                       kVersion};
    Text input{"i",
               "input",
               "Recording: rawlog, KITTI folder, folder of clouds, ROS bag, MCAP, pcap, or \"-\" "
               "for a rawlog or pcap from a pipe",
               true,
               "",
               "IN",
               cmd};
    Text output{"o", "output", "Rawlog to write", true, "", "OUT.rawlog", cmd};
    Text sensor{"", "sensor-label", "Sensor to convert: see delio-slam", false, "", "L", cmd};
    Text sensorInfo{"", "sensor-info", "Sensor description: see delio-slam", false, "", "FILE",
                    cmd};
    Text extrinsics{"",    "extrinsics", "Poses of the sensors in the vehicle: see delio-slam",
                    false, "",           "FILE",
                    cmd};
    Text vehicleBox{"",
                    "vehicle-box",
                    "Leave out points of the own vehicle: see delio-slam",
                    false,
                    "",
                    "XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX|FILE",
                    cmd};
    Text images{"", "images", "Folder with a rawlog's external files", false, "", "DIR", cmd};
    Text label{"", "label", "Sensor label in the rawlog", false, "velodyne", "LABEL", cmd};
    Number start{"", "start", "First scan to use, counted from 0", false, {}, "N", cmd};
    Number count{"", "count", "Number of scans; 0: all", false, {}, "N", cmd};
    Number every{"", "every", "Use every N-th scan", false, {1}, "N", cmd};
    TCLAP::SwitchArg embed{"", "embed", "Store the points in the rawlog instead of OUT_Images/",
                           cmd};
    TCLAP::SwitchArg force{"", "force", "Overwrite existing files", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "Print full error texts", cmd};
};

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        if (!line.empty() && line[0] != '#') lines.push_back(line);
    return lines;
}

/** Scans into a rawlog, with the rows of the side files that are theirs. */
class Conversion {
 public:
    Conversion(Arguments& args, io::ScanReader& reader)
        : args_(args),
          reader_(reader),
          truth_(linesOf(reader.truth().text)),
          writer_(args.output.getValue(), args.label.getValue(), args.embed.getValue(),
                  args.force.getValue()) {}

    /** False if Ctrl-C came before the end. What came before a fault of the recording is kept. */
    bool run() {
        const unsigned count = args_.count.getValue();
        cli::Progress progress("converting", count);
        unsigned passed = args_.start.getValue();
        while (count == 0 || writer_.scans() < count) {
            const auto scan = next(passed);
            if (cli::interrupted()) return false;
            takeSamples();
            if (!scan) break;
            add(*scan);
            progress.update(writer_.scans(), reader_.fraction());
            passed = args_.every.getValue() - 1;
        }
        if (writer_.scans() == 0)
            throw Error("'" + args_.input.getValue() + "' contains no LiDAR scans" +
                        (args_.start.getValue() > 0 ? " after --start" : ""));
        return true;
    }

    /** Fault that ended the recording early; may be empty. */
    const std::string& fault() const { return fault_; }

    std::size_t finish() {
        auto meta = reader_.meta().value_or(io::DriveMeta{});
        const auto recording = reader_.recording();
        if (meta.sensorModel == "unknown" && !recording.sensor.empty())
            meta.sensorModel = recording.sensor;
        meta.epoch_s = epoch_s_;
        takeSamples();  // fixes are complete after the last scan
        writeSamples();
        writeFixes(last_s_ + kMargin_s);
        meta.generator = std::string("scans2rawlog (delio ") + kVersion + ")";
        writer_.finish(meta, times_, reader_.calibration().text, poses_);
        return writer_.scans();
    }

 private:
    /** The scan after `passed` others; nothing at the end, or where the recording has a fault. */
    std::optional<Scan> next(unsigned passed) {
        try {
            for (unsigned i = 0; i < passed; ++i)
                if (cli::interrupted() || !reader_.skip()) break;
            auto scan = reader_.next();
            if (scan && !truth_.empty() && scan->index >= truth_.size())
                throw Error("'" + reader_.truth().name + "' has no row for scan " +
                            std::to_string(scan->index));
            return scan;
        } catch (const Error& e) {
            if (writer_.scans() == 0 && !cli::interrupted()) throw;
            fault_ = e.what();
            return {};
        }
    }

    void takeSamples() {
        for (const auto& sample : reader_.takeImu()) imu_.push_back(sample);
        for (const auto& sample : reader_.takeOdometry()) odometry_.push_back(sample);
        for (const auto& fix : reader_.takeFixes()) fixes_.push_back(fix);
    }

    void writeSamples() {
        for (const auto& sample : std::exchange(imu_, {})) writer_.add(sample, epoch_s_);
        for (const auto& sample : std::exchange(odometry_, {})) writer_.add(sample, epoch_s_);
    }

    /** Those up to a stamp; not those from long before the first scan. They may lie ahead. */
    void writeFixes(double stamp_s) {
        std::stable_sort(fixes_.begin(), fixes_.end(),
                         [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
        earth::Fixes later;
        for (const auto& fix : std::exchange(fixes_, {}))
            if (fix.stamp_s > stamp_s)
                later.push_back(fix);
            else if (fix.stamp_s >= first_s_ - kMargin_s && earth::isUsable(fix))
                writer_.add(fix, epoch_s_);
        fixes_ = std::move(later);
    }

    void add(const Scan& scan) {
        // Second 0 of the drive's stamps: MRPT's clock has the whole time.
        if (writer_.scans() == 0)
            epoch_s_ = reader_.meta() && reader_.meta()->epoch_s > 0
                           ? reader_.meta()->epoch_s
                           : std::round(mrpt::Clock::toDouble(scan.time) - scan.stamp_s);
        if (writer_.scans() == 0) first_s_ = scan.stamp_s;
        last_s_ = scan.stamp_s;
        writeSamples();
        writeFixes(scan.stamp_s);
        writer_.add(scan, epoch_s_);
        char row[48];
        std::snprintf(row, sizeof(row), "%.9f\n", scan.stamp_s);
        times_ += row;
        if (!truth_.empty()) poses_ += truth_[scan.index] + "\n";
    }

    Arguments& args_;
    io::ScanReader& reader_;
    std::vector<std::string> truth_;
    io::RawlogWriter writer_;
    std::vector<ImuSample> imu_;            //!< before the next scan
    std::vector<OdometrySample> odometry_;  //!< likewise
    earth::Fixes fixes_;
    static constexpr double kMargin_s = 1;  //!< between fixes and scans
    double epoch_s_ = 0, first_s_ = 0, last_s_ = 0;
    std::string times_, poses_, fault_;
};

/** Nothing that is read may be overwritten. */
void refuseItself(Arguments& args, const io::ScanReader& reader) {
    const std::string& input = args.input.getValue();
    // What lies beside a bag of the same name is no part of it, but what was made of it before.
    const bool isRawlog = reader.truth().name == io::sidecarPath(input, ".poses.txt");
    auto inputs = isRawlog ? cli::filesOfRawlog(input) : std::vector<std::string>{input};
    inputs.insert(inputs.end(),
                  {args.images.getValue(), args.sensorInfo.getValue(), args.extrinsics.getValue(),
                   args.vehicleBox.getValue(), reader.calibration().name, reader.truth().name});
    cli::refuseOverlap(inputs, io::RawlogWriter::outputsOf(args.output.getValue()));
}

/** Parts of the own vehicle; nothing where the command line is wrong, which is said. */
std::optional<std::vector<io::VehiclePart>> vehicleOf(Arguments& args) {
    try {
        if (args.every.getValue() == 0) throw Error("--every must be at least 1");
        if (!args.vehicleBox.isSet()) return std::vector<io::VehiclePart>();
        return io::vehiclePartsIn(args.vehicleBox.getValue());
    } catch (const Error& e) {
        cli::inform(e.what());
        return {};
    }
}

int convert(Arguments& args) {
    const auto vehicle = vehicleOf(args);
    if (!vehicle) return cli::kExitBadCommandLine;
    const std::string &input = args.input.getValue(), &output = args.output.getValue();
    if (input == "-") cli::endInputAtInterrupt();
    io::ScanSource source{input, args.sensor.getValue(), args.images.getValue(),
                          args.sensorInfo.getValue()};
    source.extrinsicsFile = args.extrinsics.getValue();
    source.vehicle = *vehicle;
    const auto reader = io::openScans(source);
    refuseItself(args, *reader);
    cli::inform("reading " + describe(reader->recording()));
    for (const auto& warning : reader->recording().warnings) cli::warn(warning);
    cli::catchInterrupts();
    Conversion conversion(args, *reader);
    if (!conversion.run()) return cli::kExitInterrupted;
    const std::size_t scans = conversion.finish();
    for (const auto& finding : reader->recording().findings) cli::warn(finding);
    for (const auto& other : reader->otherLabels()) cli::warn(io::warningOfOther(other));
    if (!conversion.fault().empty())
        throw Error(conversion.fault() + "; the " + std::to_string(scans) +
                    " scans before it are in '" + output + "'");
    cli::inform("wrote " + std::to_string(scans) + " scans to '" + output + "'");
    return cli::kExitSuccess;
}

cli::HelpText help() {
    cli::HelpText help;
    help.writes = {
        {"OUT.rawlog",
         "one CObservationPointCloud per scan, one CObservationIMU per IMU sample, one "
         "CObservationGPS per GNSS fix"},
        {"OUT_Images/",
         "their points, x y z intensity as float32 (not with --embed), and rings and times where "
         "they exist; start RawLogViewer in the rawlog's folder to see the points"},
        {"OUT.times.txt", "time of each scan, seconds"},
        {"OUT.calib.txt, OUT.poses.txt", "if the recording has them"},
        {"OUT.meta.yaml", "sensor model and processing of the points"}};
    help.examples = {
        {{"scans2rawlog -i drive.mcap -o drive.rawlog", "Convert a ROS bag for RawLogViewer"},
         {"scans2rawlog -i drive.pcap -o drive.rawlog --sensor-info sensor.json",
          "Convert packets of an Ouster"}}};
    help.interrupted = "no output is written";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments args;
    return cli::run(args.cmd, help(), argc, argv, args.verbose, [&] { return convert(args); });
}
