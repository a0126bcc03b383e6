#pragma once
#include <mrpt/containers/yaml.h>

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "delio/evaluation/relative_error.h"
#include "delio/evaluation/report.h"
#include "delio/io/trajectory.h"
#include "delio/profile.h"
#include "delio/slam.h"

namespace delio {
/** One run of delio-slam: what is gathered while it goes on, and the files that it leaves. */
class SlamRun {
 public:
    SlamRun(std::string folder, std::string profile, std::vector<std::string> command);

    /** Calibration and true poses. `truth` empty: those beside the rawlog, if any.
     *  Throws Error if the truth cannot be read, or is of cam0 and there is no Tr. */
    void readSideFiles(const std::string& rawlog, const std::string& truth,
                       const std::string& truthFrame);

    void addScan(const Scan& scan, ScanReport report, double read_ms);
    /** One line for people: what became of the scan that was added last. */
    std::string describeLastScan() const;
    void warn(const std::string& text);
    void optimise(Slam& slam);
    void write(const Slam& slam, const Options& options, bool withMap);
    void optimiseAndWrite(graph::PoseGraph& graph, const Options& options);
    void printTable(std::ostream& out) const;

    std::vector<ScanReport> reports;
    std::string fault;      //!< what ended the run early, or what was asked for and is missing
    bool complete = false;  //!< every scan was processed

 private:
    struct Metrics {
        evaluation::ReportRow row;
        evaluation::RelativeError perScan;
        double end_m = 0;
    };

    std::string path(const std::string& name) const;
    void forget(const std::string& name) const;
    io::Trajectory ofSensor(const io::Trajectory& ofVehicle) const;
    Metrics evaluate(const io::Trajectory& vehicle);
    static mrpt::containers::yaml yamlOf(const Metrics& metrics);
    /** Name and value for people to read. */
    static std::vector<std::pair<std::string, std::string>> rowsOf(const Metrics& metrics);
    void writePicture(const io::Trajectory& before) const;
    void writeTrajectories(const io::Trajectory& odometry, const io::Trajectory& final);
    void writeGraph(const graph::PoseGraph& graph);
    void writeMap(const Slam& slam, const io::Trajectory& final);
    void writeScans() const;
    void writeConfig(const Options& options) const;
    void writeSummary(const Options& options) const;
    double path_m() const;
    double msPerScan() const;
    std::size_t predictedScans() const;

    std::string folder_, profile_;
    std::vector<std::string> command_, warnings_;
    std::vector<mrpt::poses::CPose3D> sensorPoses_;
    std::vector<double> read_ms_;
    io::Calibration calibration_;
    std::optional<io::Trajectory> truth_;
    bool truthIsCam0_ = true, truthWasAskedFor_ = false, stampsRise_ = true;
    bool optimised_ = false;  //!< the graph had more edges than the odometry's
    std::optional<Metrics> metrics_, metricsBefore_;
    graph::OptimisationResult optimisation_;
    double optimise_ms_ = 0, map_ms_ = 0;
    io::Trajectory final_;
    std::vector<mrpt::poses::CPose3D> truthInPicture_;
};
}  // namespace delio
