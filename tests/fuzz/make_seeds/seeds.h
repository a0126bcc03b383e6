#pragma once
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <filesystem>
#include <string>

#include "delio/graph/pose_graph.h"
#include "test_data.h"

/** What the writers of seeds share. */
namespace delio::fuzz {
namespace fs = std::filesystem;
using test::readText;
using test::writeText;

inline const std::string kNul(1, '\0');
inline fs::path root;  //!< of the corpus

inline fs::path seed(const std::string& target, const std::string& name) {
    fs::create_directories(root / target);
    return root / target / name;
}

/** A file that a writer makes, behind what the target wants first. */
template <typename Write>
void behind(const std::string& first, const fs::path& file, const Write& write) {
    const test::TemporaryFolder folder;
    const fs::path written = folder / ("written" + file.extension().string());
    write(written);
    writeText(file, first + readText(written));
}

template <typename Stream = mrpt::io::CFileOutputStream, typename... Objects>
void archive(const fs::path& file, const Objects&... objects) {
    Stream out(file.string());
    auto to = mrpt::serialization::archiveFrom(out);
    ((to << objects), ...);
}

inline mrpt::maps::CPointsMapXYZI::Ptr cloud() {
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    for (int i = 0; i < 8; ++i) points->insertPoint(static_cast<float>(i), 2, -1.5F);
    return points;
}

inline mrpt::obs::CObservationPointCloud::Ptr cloudObservation() {
    auto observation = mrpt::obs::CObservationPointCloud::Create();
    observation->pointcloud = cloud();
    observation->sensorLabel = "lidar";
    observation->timestamp = mrpt::Clock::fromDouble(1000);
    return observation;
}

inline graph::PoseGraph smallGraph() {
    graph::PoseGraph graph;
    for (int i = 0; i < 3; ++i) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.translation().x() = i;
        graph.addNode(pose);
    }
    graph::Edge edge;
    edge.to = 1;
    edge.increment.covariance = Matrix6::Identity();
    graph.addEdge(edge);
    return graph;
}

/** Each writes FOLDER/TARGET/NAME with the project's own writers. */
void seedRawlogs();
void seedBags();
void seedMaps();
void seedTexts();
}  // namespace delio::fuzz
