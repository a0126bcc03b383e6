// Uses increments with covariances as edges of your own pose graph (here MRPT's). GNSS, an IMU or
// another map would add edges to the same nodes. Writes the graph as text.
//   03_covariances DRIVE OUT.graph
#include <delio/core/increment.h>
#include <delio/graph/pose_graph.h>
#include <delio/recordings/scan_reader.h>
#include <delio/slam/options.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <cmath>
#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "usage: 03_covariances DRIVE OUT.graph\n");
        return 2;
    }
    const auto reader = delio::io::openScans(argv[1]);
    const auto odometry = delio::makeOdometry(delio::Options::forDrive("accurate", reader->meta()));

    mrpt::graphs::CNetworkOfPoses3DInf graph;
    graph.root = 0;
    mrpt::poses::CPose3D pose;       // of the vehicle
    Eigen::Isometry3d sensorBefore;  // in the vehicle
    while (const auto scan = reader->next()) {
        const delio::Step step = odometry->process(*scan);
        const auto node = graph.nodes.size();
        if (node > 0) {
            // Odometry is the sensor's; a graph is usually the vehicle's.
            const delio::Increment increment =
                delio::ofVehicle(step.increment, sensorBefore, scan->sensorPose);
            // Elsewhere than in MRPT: `increment.covariance` itself, [x y z wx wy wz] in the later
            // frame. That is the right tangent of GTSAM and g2o; GTSAM has the rotation first.
            const auto measured = delio::graph::posePdfOf(increment);
            mrpt::poses::CPose3DPDFGaussianInf edge;
            edge.copyFrom(measured);
            graph.insertEdge(node - 1, node, edge);
            pose = pose + measured.mean;
            const auto sigma = increment.covariance.diagonal().cwiseSqrt().eval();
            std::printf("%zu %s: %.4f m +- %.4f m, +- %.4f deg\n", node,
                        step.predicted ? "predicted" : "measured", measured.mean.norm(),
                        sigma.head<3>().norm(), sigma.tail<3>().norm() * 180 / M_PI);
        }
        graph.nodes[node] = pose;
        sensorBefore = scan->sensorPose;
    }
    graph.saveToTextFile(argv[2]);
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "03_covariances: %s\n", e.what());
    return 1;
}
