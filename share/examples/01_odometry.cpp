// Computes odometry, pose graph and map of any recording that delio-slam reads. Writes the same
// result folder as delio-slam, without pictures.
//   01_odometry RECORDING OUTDIR
#include <delio/core/error.h>
#include <delio/recordings/scan_reader.h>
#include <delio/run/run.h>
#include <delio/run/run_folder.h>

#include <cstdio>
#include <exception>
#include <string>

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "usage: 01_odometry RECORDING OUTDIR\n");
        return 2;
    }
    const std::string recording = argv[1], results = argv[2];

    const auto reader = delio::io::openScans(recording);
    std::printf("%s\n", describe(reader->recording()).c_str());
    // Uses the recording's own metadata: KITTI's vertical angles are corrected by 0.205 deg, and
    // its raw drives are de-skewed.
    const auto options = delio::Options::forDrive("accurate", reader->meta());

    delio::run::RunSettings settings;
    settings.sensorLabel = reader->label();
    settings.drive = delio::io::nameOfDrive(recording);
    settings.onWarning = [](const std::string& text) {
        std::fprintf(stderr, "01_odometry: warning: %s\n", text.c_str());
    };
    delio::run::Run run(options, settings);
    run.readSideFiles(reader->calibration(), reader->truth());
    while (const auto scan = reader->next()) {
        for (const auto& sample : reader->takeImu()) run.addImu(sample);
        for (const auto& sample : reader->takeOdometry()) run.addOdometry(sample);
        run.process(*scan);
    }
    run.finish(/*complete=*/true);
    const auto fault = delio::run::RunFolder(results).write(run.record(), run.maps());
    if (!fault.empty()) throw delio::Error(fault);

    const auto& record = run.record();
    std::printf("%zu scans, %zu predicted, %.2f m\n", record.rows.size(), record.predicted(),
                record.path_m());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "01_odometry: %s\n", e.what());
    return 1;
}
