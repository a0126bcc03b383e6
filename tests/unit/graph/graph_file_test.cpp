#include "delio/graph/graph_file.h"

#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <cmath>
#include <sstream>

#include "delio/error.h"
#include "delio/graph/information.h"
#include "gauss_newton.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;

const std::string kVertices = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0 1\n";
const std::string kInformation = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
const std::string kEdge = "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1" + kInformation;

/** Poses in general position and full information matrices. */
graph::PoseGraph general(int nodes) {
    graph::PoseGraph graph;
    for (int i = 0; i < nodes; ++i)
        graph.addNode(CPose3D::FromXYZYawPitchRoll(i / 3.0, std::sin(i), -0.1 * i, 0.37 * i,
                                                   std::sin(0.9 * i), 1.7 * i));
    for (int i = 0; i + 1 < nodes; ++i) {
        graph::Edge edge{static_cast<std::size_t>(i), static_cast<std::size_t>(i) + 1, {}};
        edge.increment.pose =
            CPose3D::FromXYZYawPitchRoll(1, 0.1 * i, 1 / 7.0, 0.2 * i, 0.3 * std::sin(i), -0.7);
        Eigen::Matrix<double, 6, 6> m;
        for (int k = 0; k < 36; ++k) m(k) = 0.01 * std::sin(k * k + i);
        edge.increment.covariance.asEigen() =
            m * m.transpose() + 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
        graph.addEdge(edge);
    }
    return graph;
}

std::string faultOf(const std::string& path) {
    try {
        graph::loadG2o(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(G2o, SavedLoadedAndSavedAgainHasTheSameBytes) {
    const test::TemporaryFolder folder;
    const auto graph = general(500);
    graph::saveG2o(graph, folder / "a.g2o");
    const auto loaded = graph::loadG2o(folder / "a.g2o");
    graph::saveG2o(loaded, folder / "b.g2o");
    const std::string text = test::readText(folder / "a.g2o");
    EXPECT_EQ(text, test::readText(folder / "b.g2o"));
    EXPECT_NE(text.find("\nFIX 0\n"), std::string::npos);

    ASSERT_EQ(loaded.poses().size(), graph.poses().size());
    ASSERT_EQ(loaded.edges().size(), graph.edges().size());
    for (std::size_t i = 0; i < graph.poses().size(); ++i) {
        EXPECT_EQ(loaded.poses()[i].m_coords, graph.poses()[i].m_coords);
        EXPECT_LT((test::isometryOf(loaded.poses()[i]).linear() -
                   test::isometryOf(graph.poses()[i]).linear())
                      .cwiseAbs()
                      .maxCoeff(),
                  1e-13);
    }
    for (std::size_t i = 0; i < graph.edges().size(); ++i)
        EXPECT_EQ(loaded.information(i), graph.information(i));
}

TEST(G2o, RotationInformationIsThatOfHalfAngles) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.g2o", kVertices +
                                          "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 "
                                          "10 0 0 2 0 0 10 0 0 0 0 10 0 0 0 400 0 40 400 0 100\n");
    const auto graph = graph::loadG2o(folder / "a.g2o");
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
    const auto graph = graph::loadG2o(folder / "a.g2o");
    ASSERT_EQ(graph.poses().size(), 2U);
    EXPECT_EQ(graph.poses()[1].x(), 1);
    EXPECT_EQ(graph.edges()[0].from, 0U);
    EXPECT_EQ(graph.edges()[0].to, 1U);
    graph::saveG2o(graph, folder / "b.g2o");
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
    expect(kVertices + "VERTEX_SE2 2 0 0 0\n", "line 3: the tag 'VERTEX_SE2' is not known");
    expect(kVertices + "FIX 1\n", "line 3: FIX 1");
    expect(kVertices + "FIX 9\n", "line 3: there is no vertex 9");
}

// Information of each kind, about a pose in general position, against what the same small change of
// the numbers costs in the tangent. Roll and yaw have unequal weights (MRPT's order is yaw first).
TEST(Information, MeansTheSameInOtherTerms) {
    using graph::InformationOf;
    const CPose3D Z = CPose3D::FromXYZYawPitchRoll(1, -2, 0.5, 0.9, -0.4, 1.7);
    graph::Matrix6 information = graph::Matrix6::Zero();
    information.diagonal() << 10, 20, 30, 1000, 500, 4;
    information(3, 5) = information(5, 3) = 20;
    information(0, 4) = information(4, 0) = 15;
    const auto change = [](int k) { return 1e-5 * std::cos(5.0 * k); };
    graph::Vector6 d;
    for (int k = 0; k < 6; ++k) d[k] = change(k);
    const auto costOf = [&](const Eigen::Isometry3d& changed) {
        const auto e = test::errorOf(test::isometryOf(Z), Eigen::Isometry3d::Identity(), changed);
        return test::edgeCost(e, information, 0);
    };

    const graph::Matrix6 q = graph::convertInformation(information, Z, InformationOf::tangent,
                                                       InformationOf::quaternion);
    EXPECT_EQ(q(3, 3), 4000);
    EXPECT_EQ(q(5, 5), 16);
    EXPECT_EQ(q(3, 5), 80);
    EXPECT_EQ(q(0, 4), 30);
    EXPECT_EQ(q(2, 2), 30);
    Eigen::Isometry3d half = Eigen::Isometry3d::Identity();
    half.linear() = Eigen::Quaterniond(std::sqrt(1 - d.tail<3>().squaredNorm()), d[3], d[4], d[5])
                        .toRotationMatrix();
    half.translation() = d.head<3>();
    const double byQuaternion = costOf(test::isometryOf(Z) * half);
    EXPECT_NEAR(d.dot(q * d), byQuaternion, 1e-6 * byQuaternion);

    const graph::Matrix6 angles = graph::convertInformation(information, Z, InformationOf::tangent,
                                                            InformationOf::yawPitchRoll);
    const double byAngles = costOf(test::isometryOf(
        CPose3D::FromXYZYawPitchRoll(Z.x() + d[0], Z.y() + d[1], Z.z() + d[2], Z.yaw() + d[3],
                                     Z.pitch() + d[4], Z.roll() + d[5])));
    EXPECT_NEAR(d.dot(angles * d), byAngles, 1e-3 * byAngles);

    EXPECT_EQ(graph::convertInformation(q, Z, InformationOf::quaternion, InformationOf::tangent),
              information);
    EXPECT_LT(
        (graph::convertInformation(angles, Z, InformationOf::yawPitchRoll, InformationOf::tangent) -
         information)
            .norm(),
        1e-9);
}

TEST(G2o, AFileThatCannotBeWrittenIsAnError) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(graph::saveG2o(general(3), folder / "no/such/a.g2o"), Error);
}

TEST(MrptText, MrptReadsItsPosesBack) {
    const test::TemporaryFolder folder;
    const auto graph = general(30);
    graph::saveMrptText(graph, folder / "a.graph");
    mrpt::graphs::CNetworkOfPoses3DInf network;
    network.loadFromTextFile(folder / "a.graph");
    ASSERT_EQ(network.nodeCount(), 30U);
    EXPECT_EQ(network.root, 0U);
    ASSERT_EQ(network.edges.size(), 29U);
    const auto expectSame = [](const CPose3D& a, const CPose3D& b) {
        const Eigen::Matrix4d difference =
            test::isometryOf(a).matrix() - test::isometryOf(b).matrix();
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
    graph::saveMrptText(graph, folder / "a.graph");
    std::istringstream text(test::readText(folder / "a.graph"));
    std::string line;
    std::size_t i = 0;
    while (std::getline(text, line)) {
        std::istringstream words(line);
        std::string tag;
        std::size_t from = 0, to = 0;
        words >> tag;
        if (tag != "EDGE3") continue;
        Eigen::Matrix<double, 6, 1> mean, d;
        Eigen::Matrix<double, 6, 6> information;
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
        const Eigen::Matrix<double, 6, 1> m = mean + d;
        const auto e = test::errorOf(
            test::isometryOf(graph.edges()[i].increment.pose), Eigen::Isometry3d::Identity(),
            test::isometryOf(CPose3D::FromXYZYawPitchRoll(m[0], m[1], m[2], m[5], m[4], m[3])));
        const double cost = test::edgeCost(e, graph.information(i), 0);
        EXPECT_NEAR(d.dot(information * d), cost, 1e-3 * cost);
        ++i;
    }
    EXPECT_EQ(i, graph.edges().size());
}
}  // namespace
