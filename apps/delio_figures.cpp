// delio-figures: the paper's pictures of the stages, made of scans of a recording.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output_folder.h"
#include "delio/picture/figures.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/options.h"
#include "delio/version.h"
#include "odometry/paper_odometry.h"
#include "option_sections.h"
#include "overlap.h"
#include "paper/normals.h"
#include "paper/outlier_removal.h"
#include "picture/line_scenes.h"

namespace {
using namespace delio;

constexpr std::size_t kScans = 4;  // as many as the paper's figure shows

/** Files of the figures, as .3Dscene and .png. */
std::vector<std::string> figureFiles() {
    std::vector<std::string> files;
    for (const std::string name : {"normals_sphere", "outlier_removal", "line_cloud",
                                   "line_matches_before", "line_matches_after"})
        for (const char* kind : {".3Dscene", ".png"}) files.push_back(name + kind);
    return files;
}

/** Throws Error if an output is an input, or exists and --force is not given. */
void checkFiles(const std::string& input, const std::string& folder, bool force) {
    std::vector<std::string> outputs;
    for (const auto& file : figureFiles()) outputs.push_back(folder + "/" + file);
    cli::refuseOverlap(cli::filesOfRawlog(input), outputs);
    for (const auto& output : outputs) cli::refuseExisting(output, force);
}

/** The figures' folder; they get there when all are drawn. */
class Figures {
 public:
    explicit Figures(const std::string& folder)
        : folder_(folder), target_(folder), partial_(folder, folder) {}

    void save(const std::string& name, mrpt::opengl::COpenGLScene& scene,
              const picture::SnapshotOptions& view) const {
        const std::string path = partial_.path() / name;
        try {
            picture::saveScene(scene, path + ".3Dscene");
            picture::savePicture(scene, view, path + ".png");
        } catch (const Error& e) {
            throw Error(partial_.asInPlace(e.what()));
        }
    }

    void finish() {
        partial_.putInPlace(figureFiles());
        cli::inform("wrote " + std::to_string(figureFiles().size()) + " files to '" + folder_ +
                    "'");
    }

 private:
    std::string folder_;
    io::TargetFolder target_;
    io::PartialFolder partial_;
};

std::vector<Scan> readScans(io::ScanReader& reader, const std::string& input, std::size_t first,
                            std::size_t every) {
    for (std::size_t i = 0; i < first; ++i)
        if (!reader.skip()) break;
    std::vector<Scan> scans;
    while (scans.size() < kScans) {
        auto scan = reader.next();
        if (!scan) break;
        scans.push_back(std::move(*scan));
        for (std::size_t i = 1; i < every; ++i)
            if (!reader.skip()) break;
    }
    if (scans.size() < 2)
        throw Error("'" + input + "' has fewer than two scans from scan " + std::to_string(first) +
                    " on");
    return scans;
}

paper::SurfaceNormals normalsOf(const Scan& scan, const PaperOdometryOptions& options) {
    const auto cloud = odometry::preprocess(scan, options.scan);
    return paper::surfacesOf(cloud.points, options.normals, options.bilateral);
}

/** The pattern of scans that follow each other: it moves as the vehicle turns. */
void drawPatterns(const std::vector<Scan>& scans, const PaperOdometryOptions& options,
                  const Figures& figures) {
    std::vector<Eigen::Matrix3Xf> patterns;
    std::vector<std::string> captions;
    for (const auto& scan : scans) {
        patterns.push_back(
            paper::removeOutliers(normalsOf(scan, options), options.outliers).directions);
        captions.push_back("scan " + std::to_string(scan.index));
    }
    figures.save("normals_sphere", *picture::sphereScene(patterns, captions),
                 picture::sphereView(patterns.size()));
}

/** All normals of a scan, and what outlier removal leaves of them in steps of about as many rounds.
 */
void drawOutlierRemoval(const Scan& scan, const PaperOdometryOptions& options,
                        const Figures& figures) {
    const auto normals = normalsOf(scan, options);
    std::vector<Eigen::Matrix3Xf> steps;
    std::vector<std::string> captions;
    const unsigned rounds = paper::removeOutliers(normals, options.outliers).rounds;
    const auto shown = std::min<unsigned>(kScans - 1, rounds);
    for (unsigned step = 0; step <= shown; ++step) {
        const unsigned round = shown == 0 ? 0 : step * rounds / shown;
        steps.push_back(
            paper::removeOutliers(normals, options.outliers.firstRounds(round)).directions);
        captions.push_back(std::to_string(steps.back().cols()) + " normals");
    }
    figures.save("outlier_removal", *picture::sphereScene(steps, captions),
                 picture::sphereView(steps.size()));
}

/** The line cloud of a scan, and the pairs with the next one's before and after registration. */
void drawLines(const std::vector<Scan>& scans, const PaperOdometryOptions& options,
               const Figures& figures) {
    odometry::PaperOdometry method(options);
    const Step first = method.process(scans[0]), second = method.process(scans[1]);
    const auto linesOf = [](const Step& step) -> const paper::LineCloud& {
        return std::static_pointer_cast<const odometry::PaperFeatures>(step.features)->lines;
    };
    const Eigen::Isometry3d& pose = second.increment.pose;
    const paper::LineCloud& from = linesOf(first);
    const paper::LineCloud to = paper::rotated(linesOf(second), pose.linear());
    picture::SnapshotOptions view = picture::topView();
    view.zoom_m = 60;
    figures.save("line_cloud", *picture::lineScene(from), view);
    view.zoom_m = 30;
    figures.save("line_matches_before", *picture::matchScene(from, to, Eigen::Vector3d::Zero()),
                 view);
    figures.save("line_matches_after", *picture::matchScene(from, to, pose.translation()), view);
}

/** Options of the paper's stages from the command line. Throws Error as Options does. */
PaperOdometryOptions optionsFor(const std::string& profile, const io::ScanReader& reader,
                                const std::vector<std::string>& assignments) {
    Options options = Options::forDrive(profile, reader.meta());
    for (const auto& assignment : assignments) options.set(assignment);
    options.method.method = "paper";  // whose stages are drawn, whatever the profile goes by
    options.check();
    return options.paper;
}

cli::HelpText help() {
    cli::HelpText help;
    help.about = "Shows four scans: consecutive ones, or each Nth with --every.";
    help.sections = cli::optionSections(stagesOf(Options::ofProfile("paper")));
    help.sections.erase(help.sections.begin());  // the odometry cannot be chosen
    help.writes = {
        {"normals_sphere", "pattern of normals on the sphere, per scan"},
        {"outlier_removal", "the same for the first scan, after each round of outlier removal"},
        {"line_cloud", "line cloud of the first scan"},
        {"line_matches_before", "matched lines of two scans before registration"},
        {"line_matches_after", "the same after registration; all as .png and .3Dscene"}};
    help.examples = {{{"delio-figures -i 07.rawlog -o figures --scan 100", "Draw scans 100 to 103"},
                      {"delio-figures -i 07.rawlog -o few --set outlier_removal.rounds=1",
                       "Use one round of outlier removal"}}};
    help.interrupted = "existing files are unchanged";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("draws the paper's figures from scans of a recording", ' ', kVersion);
    using Text = TCLAP::ValueArg<std::string>;
    Text input("i", "input", "Recording: see delio-slam", true, "", "IN", cmd);
    Text output("o", "output", "Folder for the figures", true, "", "OUTDIR", cmd);
    TCLAP::ValueArg<cli::Count> scan("", "scan", "First scan to draw, counted from 0", false, {},
                                     "N", cmd);
    TCLAP::ValueArg<cli::Count> every("", "every",
                                      "Draw each Nth scan: in a bend the pattern turns visibly",
                                      false, {1}, "N", cmd);
    Text profile("", "profile", "Preset for all options that you do not set yourself", false,
                 "paper", cli::profileChoice(), cmd);
    TCLAP::MultiArg<std::string> set(
        "", "set", "Set one option; delio-slam --profile paper --print-config lists all of them",
        false, "section.key=value", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite existing files", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "Print full error texts", cmd);

    return cli::run(cmd, help(), argc, argv, verbose, [&] {
        checkFiles(input.getValue(), output.getValue(), force.getValue());
        if (every.getValue() == 0) {
            cli::inform("--every has to be 1 or more");
            return cli::kExitBadCommandLine;
        }
        const auto reader = io::openScans(input.getValue());
        PaperOdometryOptions options;
        try {
            options = optionsFor(profile.getValue(), *reader, set.getValue());
        } catch (const Error& e) {
            cli::inform(e.what());
            return cli::kExitBadCommandLine;
        }
        const auto scans = readScans(*reader, input.getValue(), scan.getValue(), every.getValue());
        Figures figures(output.getValue());
        drawPatterns(scans, options, figures);
        drawOutlierRemoval(scans[0], options, figures);
        drawLines(scans, options, figures);
        figures.finish();
        return cli::kExitSuccess;
    });
}
