#include "delio/map/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "map/page_cloud.h"

namespace delio::map {
namespace {
using Poses = std::vector<Eigen::Isometry3d>;

/** Examples of three.js that are embedded: orbit controls and wide lines. */
constexpr const char* kExamples[] = {"controls/OrbitControls.js", "lines/LineSegmentsGeometry.js",
                                     "lines/LineMaterial.js", "lines/LineSegments2.js"};

std::string readScript(const std::filesystem::path& file, const std::string& page) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream read;
    read << in.rdbuf();
    std::string text = read.str();
    if (text.empty())
        throw Error("cannot write '" + page + "': three.js is missing at '" + file.string() +
                    "'; install the package libjs-three");
    if (text.find("</script") != std::string::npos || text.find("<!--") != std::string::npos)
        throw Error("cannot write '" + page + "': '" + file.string() +
                    "' cannot be embedded in a page");
    return text + '\n';
}

/** three.js and those of its examples that a page needs, which lie beside it. */
std::string readThreeJs(const std::string& file, const std::string& page) {
    std::string text = readScript(file, page);
    const auto examples = std::filesystem::path(file).parent_path() / "examples" / "js";
    for (const char* name : kExamples) text += readScript(examples / name, page);
    return text;
}

/** JSON array of numbers; `null` for unknown values. */
void writeRange(const char* name, const ValueRange& range, bool known, std::ostream& out) {
    out << '"' << name << "\":";
    if (known)
        out << '[' << range.low << ',' << range.high << ']';
    else
        out << "null";
}

void writePath(const char* name, const Poses& poses, std::ostream& out) {
    out << ",\n\"" << name << "\":[";
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Eigen::Vector3d at = poses[i].translation();
        out << (i == 0 ? "[" : ",[") << at.x() << ',' << at.y() << ',' << at.z() << ']';
    }
    out << ']';
}

void writeCloud(const char* name, const PageCloud& cloud, std::size_t total, std::ostream& out) {
    out << ",\n\"" << name << "\":{\"shown\":" << cloud.size() << ",\"total\":" << total
        << ",\"tiles\":[";
    for (std::size_t i = 0; i < cloud.tiles.size(); ++i) {
        const auto& tile = cloud.tiles[i];
        out << (i == 0 ? "[" : ",[") << tile.origin_m[0] << ',' << tile.origin_m[1] << ','
            << tile.origin_m[2] << ',' << tile.begin << ',' << tile.count << ']';
    }
    out << "]}";
}

/** The library's own colours, as a page of its own would have them. */
void writeColours(std::ostream& out) {
    out << ",\n\"colours\":{";
    for (const auto& name : colormapNames()) {
        out << (name == colormapNames().front() ? "\"" : ",\"") << name << "\":\"" << std::hex
            << std::setfill('0');
        for (int i = 0; i < 64; ++i) {
            const auto colour = colourAt(colormapNamed(name), i / 63.0);
            for (const int channel : {colour.R, colour.G, colour.B}) out << std::setw(2) << channel;
        }
        out << std::dec << '"';
    }
    out << '}';
}

/** Range of the values: of all points, or without outliers. */
template <typename Value>
ValueRange rangeOf(const MapPoints& points, bool robust, const Value& value) {
    std::vector<float> values;
    values.reserve(points.size());
    for (const auto& point : points) values.push_back(value(point));
    if (robust) return robustRange(std::move(values));
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {double{*low}, double{*high}};
}

/** All that the page has besides the points themselves. */
class About {
 public:
    About(const PageContent& content, const MapPoints& shown, const PageScales& scales)
        : content_(content), shown_(shown), scales_(scales) {}

    void write(const PageCloud& cloud, const PageCloud& dynamic, std::ostream& out) const {
        out << std::fixed << std::setprecision(3) << "{";
        writeRanges(cloud, out);
        writeCloud("points", cloud, content_.points.size(), out);
        writeCloud("dynamic", dynamic, content_.dynamic.size(), out);
        writePath("trajectory", content_.trajectory, out);
        writePath("odometry", odometryDiffers() ? content_.odometry : Poses{}, out);
        writePath("truth", content_.truth, out);
        out << ",\n\"loops\":[";
        for (std::size_t i = 0; i < content_.loops.size(); ++i)
            out << (i == 0 ? "[" : ",[") << content_.loops[i].first << ','
                << content_.loops[i].second << ']';
        out << ']';
        if (content_.north) {
            // Thousandths, and no "-0".
            const Eigen::Array3d north = (1e3 * content_.north->array()).round() / 1e3 + 0.0;
            out << ",\n\"north\":[" << north.x() << ',' << north.y() << ']';
        }
        writeColours(out);
        out << "}\n";
    }

 private:
    void writeRanges(const PageCloud& cloud, std::ostream& out) const {
        for (int axis = 0; axis < 3; ++axis) {
            const std::string name(1, "xyz"[axis]);
            const auto place = [&](const MapPoint& point) { return point.position[axis]; };
            writeRange(name.c_str(), rangeOf(shown_, false, place), true, out);
            out << ',';
            writeRange((name + "_most").c_str(), rangeOf(shown_, true, place), true, out);
            out << ',';
        }
        std::vector<float> heights;
        for (std::size_t i = 3; i < cloud.places.size(); i += 4)
            heights.push_back(static_cast<float>(cloud.places[i] * PageCloud::kGroundQuantum_m +
                                                 PageCloud::kLowestGround_m));
        const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
        writeRange("ground", {double{*low}, double{*high}}, true, out);
        out << ',';
        writeRange("ground_most", robustRange(heights), true, out);
        const auto observations = [](const MapPoint& point) {
            return static_cast<float>(std::min<int>(point.observations, 255));
        };
        const auto any = [&](const auto& value) {
            return std::any_of(shown_.begin(), shown_.end(),
                               [&](const MapPoint& point) { return value(point) != 0; });
        };
        out << ',';
        writeRange("intensity", scales_.intensity, any([](const auto& p) { return p.intensity; }),
                   out);
        out << ',';
        writeRange("time", scales_.time_s, scales_.time_s.high > scales_.time_s.low, out);
        out << ',';
        writeRange("observations", rangeOf(shown_, true, observations), any(observations), out);
    }

    bool odometryDiffers() const {
        const auto& a = content_.trajectory;
        const auto& b = content_.odometry;
        if (a.size() != b.size()) return true;
        for (std::size_t i = 0; i < a.size(); ++i)
            if ((a[i].translation() - b[i].translation()).norm() > PageCloud::kQuantum_m)
                return true;
        return false;
    }

    const PageContent& content_;
    const MapPoints& shown_;
    const PageScales& scales_;
};

void check(const PageContent& content, const MapPoints& shown, const std::string& path) {
    const std::string beginning = "cannot write '" + path + "': ";
    if (shown.empty()) throw Error(beginning + "the map has no points");
    for (const auto* poses : {&content.trajectory, &content.odometry, &content.truth})
        for (const auto& pose : *poses)
            if (!pose.translation().allFinite())
                throw Error(beginning + "a trajectory has a pose that is not finite");
    for (const auto& [from, to] : content.loops)
        if (std::max(from, to) >= content.trajectory.size())
            throw Error(beginning + "a loop names pose " + std::to_string(std::max(from, to)) +
                        " of " + std::to_string(content.trajectory.size()));
}

template <typename Number>
void writeNumbers(const std::vector<Number>& numbers, std::ostream& out) {
    writeBase64(reinterpret_cast<const std::uint8_t*>(numbers.data()),
                numbers.size() * sizeof(Number), out);
}

/** Writes the page; `fill` writes the replacement of each {{name}}. */
template <typename Fill>
void fillTemplate(std::ostream& out, const Fill& fill) {
    const std::string& page = pageTexts().at("page.html");
    for (std::size_t at = 0; at < page.size();) {
        const std::size_t begin = std::min(page.find("{{", at), page.size());
        out.write(&page[at], static_cast<std::streamsize>(begin - at));
        if (begin == page.size()) return;
        const std::size_t end = page.find("}}", begin);
        fill(page.substr(begin + 2, end - begin - 2));
        at = end + 2;
    }
}

bool isOfLivePage(const std::string& name) { return name == "connect" || name == "live.js"; }

/** A map without points: surroundings of the start. The page widens them as points come. */
void writeLiveAbout(std::ostream& out) {
    const ValueRange around{-30, 30}, high{-3, 10}, ground{0, 6};
    out << std::fixed << std::setprecision(3) << "{";
    for (const char* name : {"x", "x_most", "y", "y_most"}) {
        writeRange(name, around, true, out);
        out << ',';
    }
    for (const char* name : {"z", "z_most"}) {
        writeRange(name, high, true, out);
        out << ',';
    }
    writeRange("ground", {-1, 20}, true, out);
    out << ',';
    writeRange("ground_most", ground, true, out);
    for (const char* name : {"intensity", "time", "observations"}) {
        out << ',';
        writeRange(name, ground, false, out);
    }
    for (const char* name : {"points", "dynamic"}) writeCloud(name, {}, 0, out);
    for (const char* name : {"trajectory", "odometry", "truth", "loops"}) writePath(name, {}, out);
    writeColours(out);
    out << "}\n";
}

GroundHeight groundOf(const MapPoints& points) {
    return GroundHeight(points.size(), [&](std::size_t i) { return points[i].position; });
}
}  // namespace

void savePage(const PageContent& content, const std::string& path, const std::string& threeJs) {
    const MapPoints shown = thinned(content.points, kMostPagePoints);
    check(content, shown, path);
    const std::string three = readThreeJs(threeJs, path);
    const PageScales scales = pageScalesOf(shown);
    const GroundHeight ground = groundOf(shown);
    const PageCloud cloud = pageCloudOf(shown, scales, ground);
    const PageCloud dynamic =
        pageCloudOf(thinned(content.dynamic, kMostPageDynamic), scales, ground);

    io::replaceTextFile(path, [&](std::ostream& out) {
        fillTemplate(out, [&](const std::string& name) {
            if (name == "title")
                out << htmlText(content.title);
            else if (name == "three.js")
                out << three;
            else if (name == "about")
                About(content, shown, scales).write(cloud, dynamic, out);
            else if (name == "places")
                writeNumbers(cloud.places, out);
            else if (name == "known")
                writeNumbers(cloud.known, out);
            else if (name == "dynamic places")
                writeNumbers(dynamic.places, out);
            else if (name == "dynamic known")
                writeNumbers(dynamic.known, out);
            else if (!isOfLivePage(name))
                out << pageTexts().at(name);
        });
    });
}

std::string livePage(const std::string& title, const std::string& threeJs) {
    const std::string three = readThreeJs(threeJs, "the live page");
    std::ostringstream out;
    fillTemplate(out, [&](const std::string& name) {
        if (name == "title")
            out << htmlText(title);
        else if (name == "three.js")
            out << three;
        else if (name == "about")
            writeLiveAbout(out);
        else if (name == "connect")
            out << "; connect-src 'self'";
        else if (name == "live.js")
            out << "<script>\n" << pageTexts().at(name) << "</script>\n";
        else if (name == "style.css" || name == "map.js")
            out << pageTexts().at(name);
    });
    return out.str();
}
}  // namespace delio::map
