// delio-figures: the paper's pictures of the stages, made of scans of a rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "cli.h"
#include "delio/error.h"
#include "delio/io/drive_meta.h"
#include "delio/io/scan_source.h"
#include "delio/map/figures.h"
#include "delio/map/scene.h"
#include "delio/odometry.h"
#include "delio/profile.h"
#include "delio/version.h"

namespace {
using namespace delio;

constexpr std::size_t kScans = 4;  // as many as the paper's figure shows

/** A figure as .3Dscene and .png. */
class Figures {
 public:
    Figures(std::string folder, bool force) : folder_(std::move(folder)), force_(force) {
        std::error_code fault;
        std::filesystem::create_directories(folder_, fault);
        if (fault) throw Error("cannot make the folder '" + folder_ + "'");
    }
    void save(const std::string& name, mrpt::opengl::COpenGLScene& scene,
              const map::SnapshotOptions& view) const {
        const std::string path = folder_ + "/" + name;
        cli::refuseExisting(path + ".3Dscene", force_);
        cli::refuseExisting(path + ".png", force_);
        map::saveScene(scene, path + ".3Dscene");
        map::savePicture(scene, view, path + ".png");
        cli::inform("wrote '" + path + ".3Dscene' and '.png'");
    }

 private:
    std::string folder_;
    bool force_;
};

std::vector<Scan> readScans(const std::string& rawlog, std::size_t first) {
    io::ScanSource source(rawlog);
    for (std::size_t i = 0; i < first; ++i)
        if (!source.skip()) break;
    std::vector<Scan> scans;
    while (scans.size() < kScans) {
        auto scan = source.next();
        if (!scan) break;
        scans.push_back(std::move(*scan));
    }
    if (scans.size() < 2)
        throw Error("'" + rawlog + "' has fewer than two scans from scan " + std::to_string(first) +
                    " on");
    return scans;
}

rotation::SurfaceNormals normalsOf(const Scan& scan, const OdometryOptions& options) {
    const auto cloud = scan::preprocess(scan, options.preprocess);
    return rotation::filterBilaterally(rotation::estimateNormals(cloud.points, options.normals),
                                       options.bilateral);
}

/** The pattern of scans that follow each other: it moves as the vehicle turns. */
void drawPatterns(const std::vector<Scan>& scans, const OdometryOptions& options,
                  const Figures& figures) {
    std::vector<Eigen::Matrix3Xf> patterns;
    std::vector<std::string> captions;
    for (const auto& scan : scans) {
        patterns.push_back(
            rotation::removeOutliers(normalsOf(scan, options), options.outliers).directions);
        captions.push_back("scan " + std::to_string(scan.index));
    }
    figures.save("normals_sphere", *map::sphereScene(patterns, captions),
                 map::sphereView(patterns.size()));
}

/** All normals of a scan, and what each round of outlier removal leaves of them. */
void drawOutlierRemoval(const Scan& scan, const OdometryOptions& options, const Figures& figures) {
    const auto normals = normalsOf(scan, options);
    std::vector<Eigen::Matrix3Xf> steps;
    std::vector<std::string> captions;
    for (unsigned round = 0; round <= options.outliers.rounds; ++round) {
        steps.push_back(
            rotation::removeOutliers(normals, options.outliers.firstRounds(round)).directions);
        captions.push_back(std::to_string(steps.back().cols()) + " normals");
    }
    figures.save("outlier_removal", *map::sphereScene(steps, captions),
                 map::sphereView(steps.size()));
}

/** The line cloud of a scan, and the pairs with the next one's before and after registration. */
void drawLines(const std::vector<Scan>& scans, const OdometryOptions& options,
               const Figures& figures) {
    OdometryOptions stages = options;
    stages.tracker.enabled = false;  // lines are drawn on the paper's way only
    Odometry odometry(stages);
    const auto from = odometry.process(scans[0]);
    const auto to = odometry.process(scans[1]);
    map::SnapshotOptions view = map::topView();
    view.zoom_m = 60;
    figures.save("line_cloud", *map::lineScene(from.features->lines), view);
    const auto& pose = to.increment.pose;
    const auto unrotated =
        translation::rotated(to.features->lines, pose.getRotationMatrix().asEigen());
    view.zoom_m = 30;
    figures.save("line_matches_before",
                 *map::matchScene(from.features->lines, unrotated, Eigen::Vector3d::Zero()), view);
    figures.save("line_matches_after",
                 *map::matchScene(from.features->lines, unrotated,
                                  Eigen::Vector3d(pose.x(), pose.y(), pose.z())),
                 view);
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("delio-figures: pictures of the stages, made of scans of a rawlog", ' ',
                       kVersion);
    using Text = TCLAP::ValueArg<std::string>;
    Text input("i", "input", "Rawlog to read", true, "", "IN.rawlog", cmd);
    Text output("o", "output", "Folder for the figures", true, "", "OUTDIR", cmd);
    TCLAP::ValueArg<cli::Count> scan("", "scan", "First of the scans that are shown, from 0", false,
                                     {}, "N", cmd);
    Text profile("", "profile", "accurate, paper or paper-literal", false, "paper", "NAME", cmd);
    TCLAP::MultiArg<std::string> set("", "set", "One option; may be repeated", false,
                                     "section.key=value", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite what exists", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "All the text of errors", cmd);

    return cli::run(cmd, argc, argv, verbose, [&] {
        Options options;
        try {
            options = Options::ofProfile(profile.getValue());
            if (const auto meta = io::readDriveMeta(input.getValue()))
                options.odometry.preprocess.vertical_correction_deg = meta->verticalCorrectionDeg;
            for (const auto& assignment : set.getValue()) options.set(assignment);
        } catch (const Error& e) {
            cli::inform(e.what());
            return cli::kExitBadCommandLine;
        }
        const auto scans = readScans(input.getValue(), scan.getValue());
        const Figures figures(output.getValue(), force.getValue());
        drawPatterns(scans, options.odometry, figures);
        drawOutlierRemoval(scans[0], options.odometry, figures);
        drawLines(scans, options.odometry, figures);
        return cli::kExitSuccess;
    });
}
