/** delio-snapshot: a picture of a map or a scene, without a display. */
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/core/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cli.h"
#include "delio/error.h"
#include "delio/map/ply.h"
#include "delio/map/scene.h"
#include "delio/map/simplemap.h"
#include "delio/map/snapshot.h"
#include "delio/version.h"

namespace {
namespace map = delio::map;
using mrpt::img::TColor;

bool parseSize(const std::string& text, unsigned& width, unsigned& height) {
    const char* const end = text.data() + text.size();
    const auto w = std::from_chars(text.data(), end, width);
    if (w.ec != std::errc{} || w.ptr == end || *w.ptr != 'x') return false;
    const auto h = std::from_chars(w.ptr + 1, end, height);
    const auto isGood = [](unsigned px) { return px >= 1 && px <= map::kMaxPictureSize_px; };
    return h.ec == std::errc{} && h.ptr == end && isGood(width) && isGood(height);
}

bool parseColour(const std::string& text, TColor& colour) {
    if (text == "white" || text == "black") {
        const std::uint8_t v = text == "white" ? 255 : 0;
        colour = TColor(v, v, v);
        return true;
    }
    unsigned rgb = 0;
    const char* const end = text.data() + text.size();
    if (text.size() != 7 || text[0] != '#') return false;
    const auto parsed = std::from_chars(text.data() + 1, end, rgb, 16);
    if (parsed.ec != std::errc{} || parsed.ptr != end) return false;
    const auto byte = [&](unsigned shift) { return static_cast<std::uint8_t>(rgb >> shift & 255); };
    colour = TColor(byte(16), byte(8), byte(0));
    return true;
}

class SizeConstraint : public TCLAP::Constraint<std::string> {
 public:
    std::string description() const override { return shortID(); }
    std::string shortID() const override { return "WxH, 1 to 16384 pixels each"; }
    bool check(const std::string& text) const override {
        unsigned width = 0, height = 0;
        return parseSize(text, width, height);
    }
};

class ColourConstraint : public TCLAP::Constraint<std::string> {
 public:
    std::string description() const override { return shortID(); }
    std::string shortID() const override { return "#rrggbb|white|black"; }
    bool check(const std::string& text) const override {
        TColor colour;
        return parseColour(text, colour);
    }
};

class RangeConstraint : public TCLAP::Constraint<double> {
 public:
    RangeConstraint(std::string unit, double min, double max)
        : text_(std::move(unit)), min_(min), max_(max) {
        text_ += ", " + textOf(min) + " to " + textOf(max);
    }
    std::string description() const override { return text_; }
    std::string shortID() const override { return text_; }
    bool check(const double& value) const override { return value >= min_ && value <= max_; }

 private:
    static std::string textOf(double value) {
        char text[32];
        return {text, std::to_chars(text, text + sizeof(text), value).ptr};
    }
    std::string text_;
    double min_, max_;
};

/** Opens whichever of the three kinds of file it is, by its name. */
mrpt::opengl::COpenGLScene::Ptr open(const std::string& path, const map::SceneOptions& options,
                                     bool colormapGiven) {
    const std::string kind = std::filesystem::path(path).extension().string();
    if (kind == ".3Dscene") {
        if (options.colourBy == map::ColourBy::Intensity)
            throw delio::Error("a .3Dscene has no intensities: take the .ply or the .simplemap");
        auto scene = map::loadScene(path);
        if (colormapGiven) map::recolour(*scene, options.colormap);
        return scene;
    }
    mrpt::maps::CPointsMapXYZI points;
    map::MapWays ways;
    if (kind == ".simplemap") {
        const auto simplemap = map::loadSimplemap(path);
        points = map::pointsOf(simplemap);
        ways.trajectory = ways.keyframes = map::posesOf(simplemap);
    } else if (kind == ".ply") {
        points = map::loadPly(path);
    } else {
        throw delio::Error("cannot read '" + path +
                           "': its name has to end in .3Dscene, .simplemap or .ply");
    }
    if (points.empty()) throw delio::Error("'" + path + "' is an empty map: nothing to show");
    return map::mapScene(points, ways, options);
}
/** OUT_000.png, OUT_001.png ... for OUT.png. */
std::string frameName(const std::string& path, unsigned frame) {
    std::filesystem::path name(path);
    name.replace_filename(name.stem().string() + mrpt::format("_%03u", frame) +
                          name.extension().string());
    return name.string();
}
}  // namespace

int main(int argc, char** argv) {
    using TCLAP::SwitchArg;
    using TCLAP::ValueArg;
    TCLAP::CmdLine cmd("Renders a picture of a map or scene; no display is needed.", ' ',
                       delio::kVersion);
    SizeConstraint sizes;
    ColourConstraint colours;
    RangeConstraint degrees("DEG", -360, 360), elevations("DEG", -90, 90);
    RangeConstraint metres("M", 1e-3, 1e6), pixels("P", 0.1, 100);
    auto colormapNames = map::colormapNames();
    TCLAP::ValuesConstraint<std::string> colormaps(colormapNames);

    ValueArg<std::string> input("i", "input", "Map or scene to show", true, "",
                                "FILE.3Dscene|FILE.simplemap|FILE.ply", cmd);
    ValueArg<std::string> output("o", "output", "Picture to write", true, "", "OUT.png", cmd);
    ValueArg<std::string> size("", "size", "Pixels (default 1920x1080)", false, "1920x1080", &sizes,
                               cmd);
    ValueArg<double> azimuth("", "azimuth",
                             "Where the camera stands: 0 on the side of +x, 90 of +y (default: "
                             "such that the longer side lies across the picture)",
                             false, 0, &degrees, cmd);
    ValueArg<double> elevation("", "elevation",
                               "Of the camera above the horizon; 90 looks straight down "
                               "(default 55, with --ortho 90)",
                               false, 55, &elevations, cmd);
    ValueArg<double> zoom("", "zoom", "Metres across the picture (default: everything)", false, 0,
                          &metres, cmd);
    SwitchArg ortho("", "ortho", "Parallel projection with a scale bar, from above", cmd);
    ValueArg<double> pointSize("", "point-size",
                               "Size of the points, pixels (default: 2 for 1080 lines, larger in "
                               "larger pictures)",
                               false, 0, &pixels, cmd);
    ValueArg<std::string> colormap("", "colormap", "Colours of the points (default turbo)", false,
                                   "turbo", &colormaps, cmd);
    std::vector<std::string> values = {"height", "intensity"};
    TCLAP::ValuesConstraint<std::string> valueNames(values);
    ValueArg<std::string> colourBy("", "color-by", "What the colours say (default height)", false,
                                   "height", &valueNames, cmd);
    ValueArg<std::string> background("", "background", "Colour behind (default: the scene's)",
                                     false, "", &colours, cmd);
    ValueArg<delio::cli::Count> frames(
        "", "orbit", "Write N pictures around the content: OUT_000.png ...", false, {}, "N", cmd);
    SwitchArg force("", "force", "Overwrite an existing picture", cmd);
    SwitchArg verbose("", "verbose", "Say more about what is done and what went wrong", cmd);

    return delio::cli::run(cmd, argc, argv, verbose, [&] {
        const unsigned count = frames.getValue();
        if (frames.isSet() && (count < 1 || count > 1000)) {
            delio::cli::inform("--orbit takes 1 to 1000 pictures; see --help");
            return delio::cli::kExitBadCommandLine;
        }
        std::vector<std::string> names;
        for (unsigned i = 0; i < count; ++i) names.push_back(frameName(output.getValue(), i));
        if (!frames.isSet()) names.push_back(output.getValue());
        for (const auto& name : names) delio::cli::refuseExisting(name, force.getValue());
        map::SnapshotOptions options;
        map::SceneOptions sceneOptions;
        parseSize(size.getValue(), options.width_px, options.height_px);
        if (azimuth.isSet()) options.azimuth_deg = azimuth.getValue();
        options.ortho = options.scaleBar = ortho.getValue();
        options.elevation_deg = options.ortho && !elevation.isSet() ? 90 : elevation.getValue();
        if (zoom.isSet()) options.zoom_m = zoom.getValue();
        if (pointSize.isSet()) options.pointSize_px = static_cast<float>(pointSize.getValue());
        if (background.isSet()) {
            TColor colour;
            parseColour(background.getValue(), colour);
            options.background = colour;
            sceneOptions.background = colour;
        }
        if (colourBy.getValue() == "intensity") sceneOptions.colourBy = map::ColourBy::Intensity;
        sceneOptions.colormap = map::colormapNamed(colormap.getValue());

        const auto scene = open(input.getValue(), sceneOptions, colormap.isSet());
        if (verbose.getValue()) delio::cli::inform("read '" + input.getValue() + "'");
        map::checkPngName(output.getValue());
        map::orbit(*scene, options, static_cast<unsigned>(names.size()),
                   [&](unsigned i, const mrpt::img::CImage& image) {
                       map::savePng(image, names[i]);
                       if (verbose.getValue()) delio::cli::inform("wrote '" + names[i] + "'");
                   });
        return delio::cli::kExitSuccess;
    });
}
