// MRPT's objects in files that are damaged, or made to do harm
// (libdelio/src/mrpt/object_archive.h).
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/maps/CWeightedPointsMap.h>
#include <mrpt/math/CMatrixF.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservation6DFeatures.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/opengl/CAssimpModel.h>
#include <mrpt/opengl/CBox.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "delio/map/simplemap.h"
#include "delio/picture/scene.h"
#include "memory_limit.h"
#include "mrpt/object_archive.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;
using mrpt::serialization::CSerializable;

std::string bytesOf(const std::vector<CSerializable::Ptr>& objects) {
    mrpt::io::CMemoryStream out;
    auto archive = mrpt::serialization::archiveFrom(out);
    for (const auto& object : objects) archive << *object;
    return {static_cast<const char*>(out.getRawBufferData()), out.getTotalBytesCount()};
}

template <typename Map>
CSerializable::Ptr scanOf() {
    auto cloud = Map::Create();
    for (int i = 0; i < 3; ++i) cloud->insertPoint(static_cast<float>(i), 1, 2);
    auto observation = CObservationPointCloud::Create();
    observation->pointcloud = cloud;
    return observation;
}

/** One of each kind for which MRPT makes room without a look whether it gets any. */
std::vector<CSerializable::Ptr> scans() {
    auto flat = mrpt::obs::CObservation2DRangeScan::Create();
    flat->resizeScan(3);
    flat->setScanHasIntensity(true);
    auto depth = mrpt::obs::CObservation3DRangeScan::Create();
    depth->hasRangeImage = true;
    depth->rangeImage_setSize(2, 3);
    depth->rangeImageOtherLayers["SECOND"] = depth->rangeImage;
    depth->hasIntensityImage = true;
    depth->intensityImage.resize(4, 4, mrpt::img::CH_GRAY);
    auto rotating = mrpt::obs::CObservationRotatingScan::Create();
    rotating->rowCount = 2;
    rotating->rangeImage.setZero(2, 3);
    rotating->intensityImage.setZero(2, 3);
    auto matrix = mrpt::math::CMatrixF::Create();
    matrix->setSize(5, 7);
    auto packets = mrpt::obs::CObservationVelodyneScan::Create();
    packets->scan_packets.resize(2);
    packets->point_cloud.x = packets->point_cloud.y = packets->point_cloud.z = {1, 2, 3};
    auto features = mrpt::obs::CObservation6DFeatures::Create();
    features->sensedFeatures.resize(2);
    auto actions = mrpt::obs::CActionCollection::Create();
    auto odometry = mrpt::obs::CObservationOdometry::Create();
    odometry->sensorLabel = "wheels";
    auto comment = mrpt::obs::CObservationComment::Create();
    comment->text = "a word";
    return {packets,
            features,
            actions,
            odometry,
            comment,
            mrpt::obs::CObservationGPS::Create(),
            mrpt::obs::CObservationIMU::Create(),
            scanOf<mrpt::maps::CSimplePointsMap>(),
            scanOf<mrpt::maps::CWeightedPointsMap>(),
            scanOf<mrpt::maps::CColouredPointsMap>(),
            cloudObservation(0, "lidar", 3),
            flat,
            depth,
            rotating,
            matrix};
}

class ObjectArchive : public ::testing::Test {
 protected:
    /** What is said of a rawlog with these bytes, and how many scans come out of it. */
    std::string faultOf(const std::string& bytes) {
        test::writeText(path_, bytes);
        io::RawlogReader reader(path_);
        return rawlog_test::faultOf(reader, scans_);
    }

    const test::TemporaryFolder folder_;
    const std::string path_ = folder_ / "a.rawlog";
    std::size_t scans_ = 0;
};

/** Wherever a number may be that counts something. */
TEST_F(ObjectArchive, NoNumberTakesAllMemory) {
    const test::MemoryLimit limit(900);
    for (const auto& scan : scans()) {
        const std::string whole = bytesOf({scan, cloudObservation(1)});
        const auto size = bytesOf({scan}).size();
        for (const std::uint32_t number : {0x3FFFFFFFU, 0x30000001U})
            for (std::size_t at = 0; at + sizeof(number) <= size; ++at) {
                std::string bytes = whole;
                std::memcpy(&bytes[at], &number, sizeof(number));
                const std::string fault = faultOf(bytes);
                EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
            }
    }
}

TEST_F(ObjectArchive, AClassThatARawlogDoesNotNeedIsNotMade) {
    const std::string fault =
        faultOf(bytesOf({cloudObservation(0), mrpt::maps::CSimpleMap::Create()}));
    EXPECT_EQ(scans_, 1U);
    EXPECT_NE(fault.find("holds 'mrpt::maps::CSimpleMap'"), std::string::npos) << fault;
    // By the name that old files have, too.
    std::string old = bytesOf({mrpt::maps::CSimpleMap::Create()});
    const std::string name = "mrpt::maps::CSimpleMap", oldName = "CSimpleMap";
    old.replace(0, 1 + name.size(), static_cast<char>(0x80 | oldName.size()) + oldName);
    EXPECT_NE(faultOf(old).find("holds 'mrpt::maps::CSimpleMap'"), std::string::npos);

    auto scene = mrpt::opengl::COpenGLScene::Create();
    scene->insert(mrpt::opengl::CAssimpModel::Create());
    const std::string file = folder_ / "a.3Dscene";
    test::writeText(file, bytesOf({scene}));
    try {
        picture::loadScene(file);
        ADD_FAILURE() << "read";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("CAssimpModel"), std::string::npos) << e.what();
    }
}

/** MRPT takes what is no distribution for one. */
TEST_F(ObjectArchive, AMovementIsOfTheKindThatItSays) {
    mrpt::obs::CActionRobotMovement2D movement;
    movement.computeFromOdometry({1, 0, 0}, {});
    auto actions = mrpt::obs::CActionCollection::Create();
    actions->insert(movement);
    const std::string bytes = bytesOf({actions, cloudObservation(0)});
    EXPECT_EQ(faultOf(bytes), "");
    EXPECT_EQ(scans_, 1U);
    const std::string name = "mrpt::obs::CActionRobotMovement2D";
    const auto method = bytes.find(name) + name.size() + 1;
    for (const char other : {'\1', '\2', 'd'}) {
        std::string damaged = bytes;
        damaged[method] = other;
        EXPECT_NE(faultOf(damaged), "") << other;
    }
}

/** libjpeg ends the process where an image is damaged. */
TEST_F(ObjectArchive, ImagesArePassedOver) {
    std::vector<CSerializable::Ptr> objects;
    for (const auto channels : {mrpt::img::CH_RGB, mrpt::img::CH_GRAY}) {
        auto image = mrpt::obs::CObservationImage::Create();
        image->image.resize(20, 10, channels);
        objects.push_back(image);
    }
    auto external = mrpt::obs::CObservationImage::Create();
    external->image.setExternalStorage("elsewhere.png");
    objects.push_back(external);
    objects.push_back(cloudObservation(0));
    const bool noJpeg = mrpt::img::CImage::DISABLE_JPEG_COMPRESSION();
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);
    std::string bytes = bytesOf(objects);
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(noJpeg);
    EXPECT_EQ(faultOf(bytes), "");
    EXPECT_EQ(scans_, 1U);
    const auto jpeg = bytes.find("\xFF\xD8\xFF");
    ASSERT_NE(jpeg, std::string::npos);
    bytes.replace(jpeg, 4, "none");
    EXPECT_EQ(faultOf(bytes), "");
    EXPECT_EQ(scans_, 1U);
}

TEST_F(ObjectArchive, ObjectsInObjectsDoNotEndTheStack) {
    const auto box = mrpt::opengl::CBox::Create();
    const auto set = mrpt::opengl::CSetOfObjects::Create();
    const auto scene = mrpt::opengl::COpenGLScene::Create();
    set->insert(box);
    scene->insert(set);
    const std::string inner = bytesOf({box}), outer = bytesOf({set});
    std::string whole = bytesOf({scene});
    const auto begin = outer.substr(0, outer.find(inner));
    const auto end = outer.substr(begin.size() + inner.size());
    const auto at = whole.find(inner);
    ASSERT_NE(at, std::string::npos);
    std::string deep;
    for (int i = 0; i < 50'000; ++i) deep += begin;
    deep += inner;
    for (int i = 0; i < 50'000; ++i) deep += end;
    const std::string file = folder_ / "a.3Dscene";
    test::writeText(file, whole);
    EXPECT_NO_THROW(picture::loadScene(file));
    test::writeText(file, whole.replace(at, inner.size(), deep));
    EXPECT_THROW(picture::loadScene(file), Error);
}

/** MRPT writes where a viewport would be. */
TEST_F(ObjectArchive, ASceneHoldsViewports) {
    const auto scene = mrpt::opengl::COpenGLScene::Create();
    scene->insert(mrpt::opengl::CBox::Create());
    scene->createViewport("small")->insert(mrpt::opengl::CSetOfObjects::Create());
    const std::string whole = bytesOf({scene});
    const std::string file = folder_ / "a.3Dscene";
    test::writeText(file, whole);
    EXPECT_EQ(picture::loadScene(file)->viewportsCount(), 2U);
    std::string one = bytesOf({mrpt::opengl::COpenGLViewport::Create()});
    one.resize(1 + std::string("mrpt::opengl::COpenGLViewport").size());
    const std::string nothing = "\x87nullptr\x88", box = bytesOf({mrpt::opengl::CBox::Create()});
    const auto first = whole.find(one), second = whole.find(one, first + 1);
    ASSERT_NE(second, std::string::npos);
    for (const auto at : {first, second})
        for (const std::string& other : {nothing, box}) {
            test::writeText(file, whole.substr(0, at) + other + whole.substr(at));
            EXPECT_THROW(picture::loadScene(file), Error);
        }
}

/** MRPT makes room for as many objects as a viewport claims to have. */
TEST_F(ObjectArchive, AViewportHasNoMoreObjectsThanItsFileCanHold) {
    const auto scene = mrpt::opengl::COpenGLScene::Create();
    scene->insert(mrpt::opengl::CBox::Create());
    std::string bytes = bytesOf({scene});
    const auto box = bytes.find(bytesOf({mrpt::opengl::CBox::Create()}).substr(0, 15));
    const std::uint32_t claimed = 0x10000000;
    ASSERT_LT(box, bytes.size());
    ASSERT_EQ(bytes.substr(box - 4, 4), std::string("\1\0\0\0", 4));
    std::memcpy(&bytes[box - 4], &claimed, sizeof(claimed));
    const std::string file = folder_ / "a.3Dscene";
    test::writeText(file, bytes);
    const test::MemoryLimit limit(900);
    io::GzInput in(file);
    io::ObjectArchive archive(in, io::FileOf::Scene);
    try {
        archive.next();
        ADD_FAILURE() << "read";
    } catch (const std::exception& e) {
        EXPECT_NE(std::string(e.what()).find("claims more than the file can hold"),
                  std::string::npos)
            << e.what();
    }
}

/** A scan is found in its folder, through a link of its owner's as well, and nowhere else. */
TEST_F(ObjectArchive, NamesOfExternalFilesDoNotLeadOutOfTheirFolder) {
    std::filesystem::create_directories(folder_ / "a_Images");
    writeValues<float>(folder_ / "0.bin", {1, 2, 3, 0});
    std::filesystem::create_symlink(folder_ / "0.bin", folder_ / "a_Images/linked.bin");
    const auto fault = [&](const std::string& name) {
        auto observation = CObservationPointCloud::Create();
        observation->setAsExternalStorage(
            name, CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
        return faultOf(bytesOf({observation}));
    };
    EXPECT_EQ(fault("linked.bin"), "");
    for (const std::string& name :
         std::vector<std::string>{"../0.bin", "x/../../0.bin", folder_ / "0.bin"})
        EXPECT_NE(fault(name).find("leads out of the folder"), std::string::npos) << fault(name);
    EXPECT_NE(fault("").find("does not say which"), std::string::npos) << fault("");
    EXPECT_NE(fault(std::string(5000, 'x')).find("none of the folders"), std::string::npos);
}

/** The limit is the host program's: its other threads allocate while an object is read. */
TEST_F(ObjectArchive, TheProcessKeepsItsMemoryLimitWhileAnObjectIsRead) {
    const std::string bytes = bytesOf({cloudObservation(0, "lidar", 200'000)});
    int ends[2] = {};
    ASSERT_EQ(pipe(ends), 0);
    const int input = dup(STDIN_FILENO);
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    io::GzInput in("-");
    dup2(input, STDIN_FILENO);
    close(input);
    rlimit before{}, during{};
    getrlimit(RLIMIT_DATA, &before);
    std::thread writer([&] {
        const auto put = [&](std::size_t from, std::size_t to) {
            while (from < to)
                from += static_cast<std::size_t>(write(ends[1], bytes.data() + from, to - from));
        };
        put(0, bytes.size() / 2);  // more than a pipe holds: the reader is in the object now
        getrlimit(RLIMIT_DATA, &during);
        put(bytes.size() / 2, bytes.size());
        close(ends[1]);
    });
    io::ObjectArchive archive(in, io::FileOf::Scans);
    EXPECT_NO_THROW(EXPECT_TRUE(archive.next()));
    writer.join();
    EXPECT_EQ(during.rlim_cur, before.rlim_cur);
}
}  // namespace
