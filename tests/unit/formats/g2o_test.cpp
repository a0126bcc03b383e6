#include "delio/formats/g2o.h"

#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <cmath>
#include <sstream>

#include "delio/core/error.h"
#include "gauss_newton.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::poseAt;

const std::string kVertices = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0 1\n";
const std::string kInformation = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
const std::string kEdge = "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1" + kInformation;

/** Poses in general position and full information matrices. */
graph::PoseGraph general(int nodes) {
    graph::PoseGraph graph;
    for (int i = 0; i < nodes; ++i)
        graph.addNode(poseAt(i / 3.0, std::sin(i), -0.1 * i, 0.37 * i, std::sin(0.9 * i), 1.7 * i));
    for (int i = 0; i + 1 < nodes; ++i) {
        graph::Edge edge{static_cast<std::size_t>(i), static_cast<std::size_t>(i) + 1, {}};
        edge.increment.pose = poseAt(1, 0.1 * i, 1 / 7.0, 0.2 * i, 0.3 * std::sin(i), -0.7);
        Matrix6 m;
        for (int k = 0; k < 36; ++k) m(k) = 0.01 * std::sin(k * k + i);
        edge.increment.covariance = m * m.transpose() + 1e-4 * Matrix6::Identity();
        graph.addEdge(edge);
    }
    return graph;
}

std::string faultOf(const std::string& path) {
    try {
        io::loadG2o(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(G2o, SavedLoadedAndSavedAgainHasTheSameBytes) {
    const test::TemporaryFolder folder;
    const auto graph = general(500);
    io::saveG2o(graph, folder / "a.g2o");
    const auto loaded = io::loadG2o(folder / "a.g2o");
    io::saveG2o(loaded, folder / "b.g2o");
    const std::string text = test::readText(folder / "a.g2o");
    EXPECT_EQ(text, test::readText(folder / "b.g2o"));
    EXPECT_NE(text.find("\nFIX 0\n"), std::string::npos);

    ASSERT_EQ(loaded.poses().size(), graph.poses().size());
    ASSERT_EQ(loaded.edges().size(), graph.edges().size());
    for (std::size_t i = 0; i < graph.poses().size(); ++i) {
        EXPECT_EQ(loaded.poses()[i].translation(), graph.poses()[i].translation());
        EXPECT_LT((loaded.poses()[i].linear() - graph.poses()[i].linear()).cwiseAbs().maxCoeff(),
                  1e-13);
    }
    for (std::size_t i = 0; i < graph.edges().size(); ++i)
        EXPECT_EQ(loaded.information(i), graph.information(i));
}

TEST(G2o, RotationsByRoundAndByTinyAnglesHaveTheSameBytesWhenSavedAgain) {
    graph::PoseGraph graph;
    for (const double degrees : {0.0, 1e-9, 1e-4, 0.18, 90.0, 120.0, 179.9999999, 180.0})
        for (const Eigen::Vector3d& axis :
             {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, -1, 1),
              Eigen::Vector3d(5.236e-4, -0.94868, 0.31623), Eigen::Vector3d(-0.2, 0.1, -0.4)})
            graph.addNode(isometry(rotationExp(degrees * M_PI / 180 * axis.normalized()),
                                   Eigen::Vector3d::Zero()));
    const test::TemporaryFolder folder;
    io::saveG2o(graph, folder / "a.g2o");
    const auto loaded = io::loadG2o(folder / "a.g2o");
    io::saveG2o(loaded, folder / "b.g2o");
    EXPECT_EQ(test::readText(folder / "a.g2o"), test::readText(folder / "b.g2o"));
    for (std::size_t i = 0; i < graph.poses().size(); ++i)
        EXPECT_LT((loaded.poses()[i].linear() - graph.poses()[i].linear()).norm(), 1e-14);
}

TEST(G2o, RotationInformationIsThatOfHalfAngles) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.g2o", kVertices +
                                          "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 "
                                          "10 0 0 2 0 0 10 0 0 0 0 10 0 0 0 400 0 40 400 0 100\n");
    const auto graph = io::loadG2o(folder / "a.g2o");
    const auto& information = graph.information(0);
    EXPECT_EQ(information(0, 0), 10);
    EXPECT_EQ(information(0, 3), 1);
    EXPECT_EQ(information(3, 0), 1);
    EXPECT_EQ(information(3, 3), 100);
    EXPECT_EQ(information(3, 5), 10);
    EXPECT_EQ(information(5, 5), 25);
    EXPECT_NEAR(graph.edges()[0].increment.covariance(4, 4), 0.01, 1e-15);
}

TEST(G2o, AcceptsAnyOrderGapsInIdsCommentsAndRoughQuaternions) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.g2o", "# a comment\n\nEDGE_SE3:QUAT 7 40 +1 2 3 0 0 0 1" +
                                          kInformation +
                                          "VERTEX_SE3:QUAT 40 1 2 3 0 0 0 -1.0009 \r\n"
                                          "  VERTEX_SE3:QUAT 7 0 0 0 0 0 0 1\nFIX 7\n\n");
    const auto graph = io::loadG2o(folder / "a.g2o");
    ASSERT_EQ(graph.poses().size(), 2U);
    EXPECT_EQ(graph.poses()[1].translation().x(), 1);
    EXPECT_EQ(graph.edges()[0].from, 0U);
    EXPECT_EQ(graph.edges()[0].to, 1U);
    io::saveG2o(graph, folder / "b.g2o");
    EXPECT_EQ(test::readText(folder / "b.g2o"), kVertices + "FIX 0\n" + kEdge);
}

TEST(G2o, EachFaultIsNamedWithItsLine) {
    const test::TemporaryFolder folder;
    const auto fault = [&](const std::string& text) {
        test::writeText(folder / "a.g2o", text);
        return faultOf(folder / "a.g2o");
    };
    const auto expect = [&](const std::string& text, const std::string& part) {
        const std::string message = fault(text);
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_NE(message.find("a.g2o"), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    };
    EXPECT_NE(faultOf(folder / "none.g2o").find("no such file"), std::string::npos);
    EXPECT_NE(faultOf(folder.path()).find("cannot read"), std::string::npos);
    expect("", "no VERTEX_SE3:QUAT");
    expect("# nothing\n", "no VERTEX_SE3:QUAT");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0\n", "line 3: the line is too short");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 1 9\n", "line 3: the line is too long");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 nan 0 0 0 0 1\n", "line 3: a number is not finite");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 1x 0 0 0 0 1\n", "'1x' is not a finite number");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 1e999 0 0 0 0 1\n", "line 3");
    expect(kVertices + "VERTEX_SE3:QUAT -2 0 0 0 0 0 0 1\n", "'-2' is not the id of a vertex");
    expect(kVertices + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n", "line 3: vertex 1 is given twice");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 1.002\n", "line 3: the quaternion");
    expect(kVertices + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 0\n", "line 3: the quaternion");
    expect(kVertices + "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 1 0 0\n", "line 3: the line is too short");
    expect(kVertices + kEdge + "EDGE_SE3:QUAT 0 5 1 2 3 0 0 0 1" + kInformation,
           "line 4: there is no vertex 5");
    expect(kVertices + "EDGE_SE3:QUAT 1 1 1 2 3 0 0 0 1" + kInformation, "line 3");
    expect(kVertices +
               "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 "
               "-1\n",
           "line 3: pose graph: the information of the edge from node 0 to node 1");
    // Of "... 100" the file may have kept "... 1".
    expect(kVertices + kEdge.substr(0, kEdge.size() - 1), "line 3: the file ends within this line");
    expect(kVertices + "VERTEX_SE2 2 0 0 0\n", "line 3: the tag 'VERTEX_SE2' is not supported");
    expect(kVertices + "FIX 1\n", "line 3: FIX 1");
    expect(kVertices + "FIX 9\n", "line 3: there is no vertex 9");
}

TEST(G2o, AFileThatCannotBeWrittenIsAnError) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(io::saveG2o(general(3), folder / "no/such/a.g2o"), Error);
}

TEST(MrptText, MrptReadsItsPosesBack) {
    const test::TemporaryFolder folder;
    const auto graph = general(30);
    io::saveMrptText(graph, folder / "a.graph", {{0, 29}});  // a line that MRPT passes over
    mrpt::graphs::CNetworkOfPoses3DInf network;
    network.loadFromTextFile(folder / "a.graph");
    ASSERT_EQ(network.nodeCount(), 30U);
    EXPECT_EQ(network.root, 0U);
    ASSERT_EQ(network.edges.size(), 29U);
    const auto expectSame = [](const mrpt::poses::CPose3D& a, const Eigen::Isometry3d& b) {
        const Eigen::Matrix4d difference = fromMrpt(a).matrix() - b.matrix();
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12);
    };
    for (std::size_t i = 0; i < 30; ++i) expectSame(network.nodes.at(i), graph.poses()[i]);
    auto edge = network.edges.begin();
    for (std::size_t i = 0; i < 29; ++i, ++edge)
        expectSame(edge->second.mean, graph.edges()[i].increment.pose);
}

// The information in the file belongs to the numbers before it, x y z roll pitch yaw: moving those
// must cost what the moved pose costs. Read here from the text, as MRPT 2.5.8 drops what it reads
// about two different angles.
TEST(MrptText, ItsInformationGivesTheSameCost) {
    const test::TemporaryFolder folder;
    const auto graph = general(30);
    io::saveMrptText(graph, folder / "a.graph");
    std::istringstream text(test::readText(folder / "a.graph"));
    std::string line;
    std::size_t i = 0;
    while (std::getline(text, line)) {
        std::istringstream words(line);
        std::string tag;
        std::size_t from = 0, to = 0;
        words >> tag;
        if (tag != "EDGE3") continue;
        Vector6 mean, d;
        Matrix6 information;
        words >> from >> to;
        for (int k = 0; k < 6; ++k) words >> mean[k];
        for (int r = 0; r < 6; ++r)
            for (int c = r; c < 6; ++c) {
                words >> information(r, c);
                information(c, r) = information(r, c);
            }
        ASSERT_TRUE(words) << line;
        ASSERT_LT(i, graph.edges().size());
        EXPECT_EQ(from, graph.edges()[i].from);
        for (int k = 0; k < 6; ++k) d[k] = 1e-5 * std::cos(5.0 * k + static_cast<double>(i));
        const Vector6 m = mean + d;
        const auto e = test::errorOf(graph.edges()[i].increment.pose, Eigen::Isometry3d::Identity(),
                                     poseAt(m[0], m[1], m[2], m[5], m[4], m[3]));
        const double cost = test::edgeCost(e, graph.information(i), 0);
        EXPECT_NEAR(d.dot(information * d), cost, 1e-3 * cost);
        ++i;
    }
    EXPECT_EQ(i, graph.edges().size());
}
}  // namespace
