/** delio-snapshot: a picture of a map or a scene, without a display. */
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/core/format.h>

#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "delio/version.h"
#include "map_input.h"
#include "overlap.h"

namespace {
namespace map = delio::map;
namespace picture = delio::picture;
using mrpt::img::TColor;
using Text = TCLAP::ValueArg<std::string>;
using Number = TCLAP::ValueArg<double>;
using Words = TCLAP::ValuesConstraint<std::string>;

/** Width and height of "WxH". */
std::optional<std::pair<unsigned, unsigned>> sizeIn(const std::string& text) {
    const auto x = text.find('x');
    if (x == text.npos) return {};
    const auto width = delio::numberIn<unsigned>(text.substr(0, x));
    const auto height = delio::numberIn<unsigned>(text.substr(x + 1));
    const auto isGood = [](const std::optional<unsigned>& px) {
        return px && *px >= 1 && *px <= picture::kMaxPictureSize_px;
    };
    if (!isGood(width) || !isGood(height)) return {};
    return std::make_pair(*width, *height);
}

std::optional<TColor> colourIn(const std::string& text) {
    if (text == "white") return TColor(255, 255, 255);
    if (text == "black") return TColor(0, 0, 0);
    if (text.size() != 7 || text[0] != '#' ||
        text.find_first_not_of("0123456789abcdefABCDEF", 1) != text.npos)
        return {};
    const unsigned long rgb = std::stoul(text.substr(1), nullptr, 16);
    const auto byte = [&](unsigned shift) { return static_cast<std::uint8_t>(rgb >> shift & 255); };
    return TColor(byte(16), byte(8), byte(0));
}

class SizeConstraint : public TCLAP::Constraint<std::string> {
 public:
    std::string description() const override { return shortID(); }
    std::string shortID() const override { return "WxH, 1 to 16384 pixels each"; }
    bool check(const std::string& text) const override { return sizeIn(text).has_value(); }
};

class ColourConstraint : public TCLAP::Constraint<std::string> {
 public:
    std::string description() const override { return shortID(); }
    std::string shortID() const override { return "#rrggbb|white|black"; }
    bool check(const std::string& text) const override { return colourIn(text).has_value(); }
};

class RangeConstraint : public TCLAP::Constraint<double> {
 public:
    RangeConstraint(std::string unit, double min, double max)
        : text_(std::move(unit)), min_(min), max_(max) {
        text_ += ", " + delio::digitsOf(min) + " to " + delio::digitsOf(max);
    }
    std::string description() const override { return text_; }
    std::string shortID() const override { return text_; }
    bool check(const double& value) const override { return value >= min_ && value <= max_; }

 private:
    std::string text_;
    double min_, max_;
};

/** Opens whichever kind of file it is, by its name. */
mrpt::opengl::COpenGLScene::Ptr open(const std::string& path, const picture::SceneOptions& options,
                                     bool colormapGiven, std::optional<double> maxHeight_m) {
    if (std::filesystem::path(path).extension() == ".3Dscene") {
        if (options.colourBy != picture::ColourBy::Height)
            throw delio::Error(
                "a .3Dscene holds only points and colours; give the map's .ply instead");
        auto scene = picture::loadScene(path);
        if (maxHeight_m) picture::cutAbove(*scene, *maxHeight_m);
        if (colormapGiven) picture::recolour(*scene, options.colormap);
        return scene;
    }
    constexpr double kStoredSpacing_m = 0.3;
    auto map = delio::readMap(path, kStoredSpacing_m);
    if (maxHeight_m) map::cutAbove(map.points, map.dynamic, *maxHeight_m);
    return picture::mapScene(map.points, map.drawnWays(), options);
}

/** OUT_000.png, OUT_001.png ... for OUT.png. */
std::string frameName(const std::string& path, unsigned frame) {
    std::filesystem::path name(path);
    name.replace_filename(name.stem().string() + mrpt::format("_%03u", frame) +
                          name.extension().string());
    return name.string();
}

/** Command-line arguments. */
struct Arguments {
    Arguments();
    std::vector<std::string> pictureNames();
    picture::SnapshotOptions view();
    picture::SceneOptions scene();

    TCLAP::CmdLine cmd;
    SizeConstraint sizes;
    ColourConstraint colours;
    RangeConstraint degrees{"DEG", -360, 360}, elevations{"DEG", -90, 90};
    RangeConstraint metres{"M", 1e-3, 1e6}, heights{"M", 1e-3, 1000}, pixels{"P", 0.1, 100},
        strengths{"S", 0, 4}, factors{"F", 0.2, 20};
    std::vector<std::string> colormapNames = map::colormapNames();
    std::vector<std::string> valueNames = map::colourByNames();
    Words colormaps{colormapNames}, values{valueNames};

    Text input, output, size;
    Number azimuth, elevation, zoom;
    TCLAP::SwitchArg ortho;
    Number maxHeight, pointSize, shading, marks;
    Text colormap, colourBy, background;
    TCLAP::ValueArg<delio::cli::Count> frames;
    TCLAP::SwitchArg force, verbose;
};

Arguments::Arguments()
    : cmd("renders a map or scene to an image, without a display", ' ', delio::kVersion),
      input("i", "input", "Map or scene", true, "",
            "FILE.3Dscene|FILE.simplemap|FILE.delio|FILE.ply|FILE.pcd", cmd),
      output("o", "output", "Image to write", true, "", "OUT.png", cmd),
      size("", "size", "Image size", false, "1920x1080", &sizes, cmd),
      azimuth("", "azimuth",
              "Direction from which the camera looks: 0 from +x, 90 from +y (default: the longer "
              "side of the map lies horizontally)",
              false, 0, &degrees, cmd),
      elevation("", "elevation",
                "Elevation of the camera above the horizon; 90 looks straight down (default with "
                "--ortho)",
                false, 55, &elevations, cmd),
      zoom("", "zoom", "Width of the visible area, metres (default: everything)", false, 0, &metres,
           cmd),
      ortho("", "ortho", "Orthographic view from above: a plan", cmd),
      maxHeight("", "max-height",
                "Leave out points higher than this above the ground around them, metres; with "
                "--ortho a floor plan of rooms",
                false, 0, &heights, cmd),
      pointSize(
          "", "point-size",
          "Point size, pixels (default: 2 at 1080 lines, larger in larger images and close-ups)",
          false, 0, &pixels, cmd),
      shading("", "shading", "Strength of edge shading (eye-dome lighting); 0: off", false, 1,
              &strengths, cmd),
      marks("", "marks",
            "Factor of the size of letters, lines and symbols; 4: legible in a column of print",
            false, 1, &factors, cmd),
      colormap("", "colormap", "Colour map", false, "turbo", &colormaps, cmd),
      colourBy("", "color-by", "Value shown by the colours", false, "height", &values, cmd),
      background("", "background", "Background colour (default: the scene's)", false, "", &colours,
                 cmd),
      frames("", "orbit",
             "Write N images on a circle around the map, 1 to 1000: OUT_000.png ...; default: one "
             "image",
             false, {}, "N", cmd),
      force("", "force", "Overwrite existing images", cmd),
      verbose("", "verbose", "Print progress and full error texts", cmd) {}

picture::SnapshotOptions Arguments::view() {
    picture::SnapshotOptions options;
    std::tie(options.width_px, options.height_px) = sizeIn(size.getValue()).value();
    if (azimuth.isSet()) options.azimuth_deg = azimuth.getValue();
    options.ortho = ortho.getValue();
    options.scaleBar = options.northArrow = true;
    options.elevation_deg = options.ortho && !elevation.isSet() ? 90 : elevation.getValue();
    if (zoom.isSet()) options.zoom_m = zoom.getValue();
    if (pointSize.isSet()) options.pointSize_px = static_cast<float>(pointSize.getValue());
    options.shading = shading.getValue();
    options.marks = marks.getValue();
    options.background = colourIn(background.getValue());
    return options;
}

picture::SceneOptions Arguments::scene() {
    picture::SceneOptions options;
    if (const auto colour = colourIn(background.getValue())) options.background = *colour;
    options.colourBy = map::colourByNamed(colourBy.getValue());
    options.colormap = map::colormapNamed(colormap.getValue());
    return options;
}

std::vector<std::string> Arguments::pictureNames() {
    if (!frames.isSet()) return {output.getValue()};
    std::vector<std::string> names;
    for (unsigned i = 0; i < frames.getValue(); ++i)
        names.push_back(frameName(output.getValue(), i));
    return names;
}

/** All of the pictures or, where one cannot be written, none. */
void save(mrpt::opengl::COpenGLScene& scene, const picture::SnapshotOptions& view,
          const std::string& output, const std::vector<std::string>& files) {
    delio::io::PartialFolder partial(delio::io::folderOf(output), output);
    std::vector<std::string> names;
    names.reserve(files.size());
    for (const auto& file : files) names.push_back(std::filesystem::path(file).filename().string());
    try {
        picture::orbit(scene, view, static_cast<unsigned>(names.size()),
                       [&](unsigned i, const mrpt::img::CImage& image) {
                           picture::savePng(image, partial.path() / names[i]);
                       });
    } catch (const delio::Error& e) {
        throw delio::Error(partial.asInPlace(e.what()));
    }
    partial.putInPlace(names);
}

void render(Arguments& asked) {
    const auto say = [&](const std::string& text) {
        if (asked.verbose.getValue()) delio::cli::inform(text);
    };
    const auto files = asked.pictureNames();
    const std::string& input = asked.input.getValue();
    delio::cli::refuseOverlap(delio::mapFilesIn(input), files);
    for (const auto& file : files) delio::cli::refuseExisting(file, asked.force.getValue());
    std::optional<double> maxHeight_m;
    if (asked.maxHeight.isSet()) maxHeight_m = asked.maxHeight.getValue();
    const auto scene = open(input, asked.scene(), asked.colormap.isSet(), maxHeight_m);
    say("read '" + input + "'");
    picture::checkPngName(asked.output.getValue());
    const delio::io::OutputLock lock(asked.output.getValue());
    save(*scene, asked.view(), asked.output.getValue(), files);
    for (const auto& file : files) say("wrote '" + file + "'");
}

delio::cli::HelpText help() {
    delio::cli::HelpText help;
    help.writes = {{"OUT.png", "the picture"},
                   {"OUT_000.png ...", "with --orbit: one per viewing direction"}};
    help.examples = {
        {{"delio-snapshot -i 07-results/map.3Dscene -o 07.png --azimuth 30", "View from the side"},
         {"delio-snapshot -i flat.ply -o plan.png --ortho --max-height 2",
          "Floor plan of rooms, without ceilings"}}};
    help.interrupted = "existing files are unchanged";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments asked;
    return delio::cli::run(asked.cmd, help(), argc, argv, asked.verbose, [&] {
        const unsigned count = asked.frames.getValue();
        if (asked.frames.isSet() && (count < 1 || count > 1000)) {
            delio::cli::inform("--orbit needs 1 to 1000 images; see --help");
            return delio::cli::kExitBadCommandLine;
        }
        render(asked);
        return delio::cli::kExitSuccess;
    });
}
