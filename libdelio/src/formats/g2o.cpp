#include "delio/formats/g2o.h"

#include <mrpt/graphs/CNetworkOfPoses.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "graph/residual.h"

namespace delio::io {
using graph::convertInformation;
using graph::Edge;
using graph::InformationOf;
using graph::PoseGraph;

namespace {
using VertexId = unsigned long long;

/** The words of one line, taken one after the other. */
class Line {
 public:
    Line(const std::string& text, std::string where) : words_(text), where_(std::move(where)) {}

    bool empty() { return (words_ >> std::ws).eof(); }
    [[noreturn]] void fail(const std::string& why) const { throw Error(where_ + ": " + why); }
    const std::string& where() const { return where_; }

    std::string word() {
        std::string word;
        if (!(words_ >> word)) fail("the line is too short for its tag");
        return word;
    }

    VertexId id() { return parsed<VertexId>("the id of a vertex"); }

    double number() {
        const double value = parsed<double>("a finite number");
        if (!std::isfinite(value)) fail("a number is not finite");
        return value;
    }

    Eigen::Isometry3d pose() {
        std::array<double, 7> v{};
        for (double& value : v) value = number();
        Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
        if (!(std::abs(q.norm() - 1) <= 1e-3)) fail("the quaternion is not of length 1");
        return isometry(q.normalized().toRotationMatrix(), {v[0], v[1], v[2]});
    }

    Matrix6 symmetric() {
        Matrix6 m;
        for (int r = 0; r < 6; ++r)
            for (int c = r; c < 6; ++c) m(r, c) = m(c, r) = number();
        return m;
    }

    void end() {
        if (!empty()) fail("the line is too long for its tag");
    }

 private:
    template <typename Number>
    Number parsed(const std::string& what) {
        const std::string text = word();
        const auto value = numberIn<Number>(text[0] == '+' ? text.substr(1) : text);
        if (!value) fail("'" + text.substr(0, 20) + "' is not " + what);
        return *value;
    }

    std::istringstream words_;
    std::string where_;
};

struct FileEdge {
    VertexId from, to;
    Eigen::Isometry3d pose;
    Matrix6 information;
    std::string where;
};

struct FileContent {
    std::map<VertexId, Eigen::Isometry3d> vertices;
    std::vector<FileEdge> edges;
    std::vector<std::pair<VertexId, std::string>> fixed;  //!< with the place in the file
};

void readLine(Line& line, FileContent& content) {
    const std::string tag = line.word();
    if (tag == "VERTEX_SE3:QUAT") {
        const VertexId id = line.id();
        if (!content.vertices.emplace(id, line.pose()).second)
            line.fail("vertex " + std::to_string(id) + " is given twice");
    } else if (tag == "EDGE_SE3:QUAT") {
        const VertexId from = line.id();
        const VertexId to = line.id();
        const Eigen::Isometry3d pose = line.pose();
        content.edges.push_back(
            {from, to, pose,
             convertInformation(line.symmetric(), pose, InformationOf::quaternion,
                                InformationOf::tangent),
             line.where()});
    } else if (tag == "FIX") {
        content.fixed.emplace_back(line.id(), line.where());
    } else {
        line.fail("the tag '" + tag.substr(0, 40) +
                  "' is not supported; supported are VERTEX_SE3:QUAT, EDGE_SE3:QUAT and FIX");
    }
    line.end();
}

FileContent readContent(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    FileContent content;
    std::string text;
    for (std::size_t number = 1; std::getline(in, text); ++number) {
        Line line(text, "'" + path + "', line " + std::to_string(number));
        if (text[0] == '#' || line.empty()) continue;
        // The last number may have lost digits without a trace.
        if (in.eof()) line.fail("the file ends within this line (cut off?)");
        readLine(line, content);
    }
    if (in.bad()) throw Error("cannot read '" + path + "': reading failed (a folder?)");
    if (content.vertices.empty()) throw Error("'" + path + "' has no VERTEX_SE3:QUAT line");
    return content;
}

/** The unit quaternion of a rotation with w >= 0, such that a file that is loaded and saved again
 * has the same bytes: three components are rounded to 2^-48 (4e-15), which is more than the way to
 * a matrix and back changes them, and the fourth follows from these. */
Eigen::Quaterniond repeatableQuaternion(const Eigen::Matrix3d& R) {
    constexpr double kGrid = 0x1p48;
    // One component is 0.5 or more. Rotations by 90, 120 and 180 deg are not near this threshold.
    constexpr double kLarge = 0.45;
    Eigen::Vector4d q = Eigen::Quaterniond(R).normalized().coeffs();  // x y z w
    Eigen::Index fourth = 3;
    while (fourth > 0 && std::abs(q[fourth]) < kLarge) --fourth;
    if (q[fourth] < 0) q = -q;
    q[fourth] = 0;
    q = (kGrid * q).array().round() / kGrid;
    q[fourth] = std::sqrt(1 - q.squaredNorm());
    if (q[3] < 0) q = -q;
    return Eigen::Quaterniond(Eigen::Vector4d(q.array() + 0.0));  // no -0
}

void writeNumber(std::ostream& out, double number) { out << ' ' << digitsOf(number); }

void writePose(std::ostream& out, const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d t = pose.translation();
    const auto q = repeatableQuaternion(pose.linear());
    for (const double number : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
        writeNumber(out, number);
}
}  // namespace

PoseGraph loadG2o(const std::string& path) {
    const FileContent content = readContent(path);
    PoseGraph graph;
    std::map<VertexId, std::size_t> nodes;
    for (const auto& [id, pose] : content.vertices) nodes[id] = graph.addNode(pose);
    const auto nodeOf = [&](VertexId id, const std::string& where) {
        const auto node = nodes.find(id);
        if (node == nodes.end()) throw Error(where + ": there is no vertex " + std::to_string(id));
        return node->second;
    };
    for (const auto& [id, where] : content.fixed)
        if (nodeOf(id, where) != 0)
            throw Error(where + ": FIX " + std::to_string(id) +
                        ": only the vertex with the smallest id can be fixed");
    for (const auto& edge : content.edges) {
        const std::size_t from = nodeOf(edge.from, edge.where);
        const std::size_t to = nodeOf(edge.to, edge.where);
        try {
            graph.addEdge(from, to, edge.pose, edge.information);
        } catch (const Error& e) {
            throw Error(edge.where + ": " + e.what());
        }
    }
    return graph;
}

void saveG2o(const PoseGraph& graph, const std::string& path) {
    replaceTextFile(path, [&](std::ostream& out) {
        for (std::size_t i = 0; i < graph.poses().size(); ++i) {
            out << "VERTEX_SE3:QUAT " << i;
            writePose(out, graph.poses()[i]);
            out << '\n';
        }
        out << "FIX 0\n";
        for (std::size_t i = 0; i < graph.edges().size(); ++i) {
            const Edge& edge = graph.edges()[i];
            out << "EDGE_SE3:QUAT " << edge.from << ' ' << edge.to;
            writePose(out, edge.increment.pose);
            const Matrix6 information =
                convertInformation(graph.information(i), edge.increment.pose,
                                   InformationOf::tangent, InformationOf::quaternion);
            for (int r = 0; r < 6; ++r)
                for (int c = r; c < 6; ++c) writeNumber(out, information(r, c));
            out << '\n';
        }
    });
}

void saveMrptText(const PoseGraph& graph, const std::string& path,
                  const std::vector<std::pair<std::size_t, std::size_t>>& loops) {
    mrpt::graphs::CNetworkOfPoses3DInf network;
    network.root = 0;
    for (std::size_t i = 0; i < graph.poses().size(); ++i)
        network.nodes[i] = toMrpt(graph.poses()[i]);
    for (std::size_t i = 0; i < graph.edges().size(); ++i) {
        const Edge& edge = graph.edges()[i];
        mrpt::poses::CPose3DPDFGaussianInf measured(toMrpt(edge.increment.pose));
        measured.cov_inv.asEigen() =
            convertInformation(graph.information(i), edge.increment.pose, InformationOf::tangent,
                               InformationOf::yawPitchRoll);
        network.insertEdge(edge.from, edge.to, measured);
    }
    replaceTextFile(path, [&](std::ostream& out) {
        out.precision(17);
        network.writeAsText(out);
        for (const auto& [from, to] : loops) out << "# loop " << from << ' ' << to << '\n';
    });
}
}  // namespace delio::io
