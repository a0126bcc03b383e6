#include "object_archive.h"

#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/rtti/CObject.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace delio::io {
namespace {
/** Classes of what a sensor saw, and of where it was, beside the observations; without "mrpt::". */
constexpr std::string_view kOfScans =
    " maps::CColouredPointsMap maps::CPointsMapXYZI maps::CSimplePointsMap "
    "maps::CWeightedPointsMap maps::TMapGenericParams math::CMatrixB math::CMatrixD "
    "math::CMatrixF img::CImage img::TCamera img::TStereoCamera obs::CActionCollection "
    "obs::CActionRobotMovement2D obs::CActionRobotMovement3D obs::CSensoryFrame "
    "poses::CPoint2D poses::CPoint3D poses::CPointPDFGaussian poses::CPose2D "
    "poses::CPose3D poses::CPose3DPDFGaussian poses::CPose3DPDFGaussianInf "
    "poses::CPose3DPDFParticles poses::CPose3DPDFSOG poses::CPose3DQuat "
    "poses::CPose3DQuatPDFGaussian poses::CPose3DQuatPDFGaussianInf "
    "poses::CPosePDFGaussian poses::CPosePDFGaussianInf poses::CPosePDFParticles "
    "poses::CPosePDFSOG ";

/** Shapes that hold what they show; not models that are read from other files. */
constexpr std::string_view kOfScenes =
    " img::CImage img::TCamera math::CMatrixB math::CMatrixD math::CMatrixF "
    "obs::CObservation2DRangeScan opengl::CArrow opengl::CAxis opengl::CBox "
    "opengl::CCamera opengl::CColorBar opengl::CCylinder opengl::CDisk "
    "opengl::CEllipsoid2D opengl::CEllipsoid3D opengl::CFrustum opengl::CGridPlaneXY "
    "opengl::CGridPlaneXZ opengl::COctoMapVoxels opengl::COpenGLScene "
    "opengl::COpenGLViewport opengl::CPlanarLaserScan opengl::CPointCloud "
    "opengl::CPointCloudColoured opengl::CSetOfLines opengl::CSetOfObjects "
    "opengl::CSetOfTriangles opengl::CSimpleLine opengl::CSphere opengl::CText "
    "opengl::CText3D opengl::CTexturedPlane opengl::CSetOfTexturedTriangles poses::CPose3D ";

/** Whether such a file may hold objects of this class of MRPT. What is not needed is not made: some
 *  of MRPT's classes open other files, or crash on damaged ones. */
bool isKnown(std::string_view className, FileOf file) {
    constexpr std::string_view kMrpt = "mrpt::", kObservation = "obs::CObservation";
    if (className.substr(0, kMrpt.size()) != kMrpt) return false;
    className.remove_prefix(kMrpt.size());
    const auto isIn = [&](std::string_view names) {
        return names.find(' ' + std::string(className) + ' ') != names.npos;
    };
    if (file == FileOf::Scene) return isIn(kOfScenes);
    const bool isObservation = className.size() > kObservation.size() &&
                               className.substr(0, kObservation.size()) == kObservation &&
                               className != "obs::CObservation3DScene";
    return isObservation || isIn(kOfScans) ||
           (file == FileOf::Keyframes && className == "maps::CSimpleMap");
}

constexpr unsigned kAll = std::numeric_limits<unsigned>::max();

bool endsWith(std::string_view text, std::string_view end) {
    return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

constexpr std::uint64_t kPoints = 10'000'000;

/** The same of shapes. Each begins with the length of its name and the six floats of its pose. */
ObjectArchive::Counts countsInScene(std::string_view className) {
    constexpr unsigned kBefore = 7, kOfList = 3;  // two names and the count of a list
    constexpr std::array<std::pair<std::string_view, unsigned>, 8> kKnown{
        {{"::CPointCloud", 2},
         {"::CPointCloudColoured", 2 * kOfList},
         {"::CSetOfLines", kOfList},
         {"::CSetOfObjects", 1},
         {"::CSetOfTriangles", 1},
         {"::CSetOfTexturedTriangles", 1},
         {"::CText", 1},
         {"::CText3D", 2}}};
    for (const auto& [end, counts] : kKnown)
        if (endsWith(className, end)) return {counts, kPoints, true, false, kBefore};
    return {};
}

/** Which numbers after the name of such a class are checked. Nothing: as in the object that it is
 *  part of. The limits are above what a scan has, and no more than some hundred MB of elements. */
std::optional<ObjectArchive::Counts> countsIn(std::string_view className, FileOf file) {
    using Counts = ObjectArchive::Counts;
    const auto is = [&](std::string_view end) { return endsWith(className, end); };
    constexpr std::uint64_t kPacketsOrPoints = 600'000, kMany = 1'000'000;
    if (is("::CMatrixF") || is("::CMatrixD")) return Counts{2, kPoints};
    if (is("::CMatrixB")) return Counts{3, kPoints};
    if (is("RangeScan") || is("RotatingScan") || className.find("PointsMap") != className.npos)
        return Counts{kAll, kPoints};
    const bool isPart = is("::TCamera") || is("::CImage") || is("::TMapGenericParams") ||
                        className.find("::CPose") != className.npos;
    if (isPart) return {};
    if (is("::CCamera")) return {};  // after it comes the number of the viewport's objects
    if (is("::COpenGLViewport")) return Counts{kAll, kMany, true};
    if (file == FileOf::Scene) return countsInScene(className);
    if (is("::CObservationVelodyneScan")) return Counts{kAll, kPacketsOrPoints, true};
    if (is("::CObservationComment")) return Counts{kAll, kPoints, true};  // its text
    const bool hasFloats = is("::CActionRobotMovement2D") || is("::CActionRobotMovement3D") ||
                           is("::CObservationOdometry") || is("::CObservationBearingRange");
    return Counts{kAll, kMany, true, hasFloats};
}

/** Also -0, and what rounding leaves of 0; but not larger than lengths, angles and speeds are. */
bool isLikeAFloat(std::uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, sizeof(value));
    return std::abs(value) < 1e9F;
}

template <typename Value>
Value readAs(GzInput& in) {
    Value value{};
    if (in.Read(&value, sizeof(value)) != sizeof(value))
        throw std::runtime_error("the file ends early");
    return value;
}

void skip(GzInput& in, std::uint64_t bytes) {
    std::array<char, 1U << 14> unused{};
    while (bytes > 0) {
        const auto some = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, unused.size()));
        if (in.Read(unused.data(), some) != some) throw std::runtime_error("the file ends early");
        bytes -= some;
    }
}

void skipCounted(GzInput& in) { skip(in, readAs<std::uint32_t>(in)); }

void skipGrey(GzInput& in, std::uint8_t version) {
    skip(in, 3 * sizeof(std::int32_t));  // width, height, origin
    const auto size = readAs<std::uint32_t>(in);
    if (version >= 9) skip(in, sizeof(std::int32_t));  // depth
    constexpr std::uint32_t kSmall = 16 * 1024;        // these version 4 does not compress
    bool isZip = version == 3 || (version == 4 && size > kSmall);
    if (version >= 5) isZip = readAs<std::uint8_t>(in) != 0;
    if (isZip)
        skipCounted(in);
    else
        skip(in, size);
}

void skipColour(GzInput& in, std::uint8_t version) {
    if (version < 7) return skipCounted(in);
    const std::int64_t width = readAs<std::int32_t>(in), height = readAs<std::int32_t>(in);
    if (width >= 1 && height >= 1) return skipCounted(in);  // JPEG
    // Not compressed: the sizes are negative. Width or height of 0: nothing follows.
    if (width < 0 && height < 0) skip(in, static_cast<std::uint64_t>(width * height) * 3);
}

/** Reads past what follows the version of a mrpt::img::CImage. Throws std::runtime_error for a
 *  version that MRPT does not read either, and where the file ends. */
void skipImage(GzInput& in, std::uint8_t version) {
    constexpr std::uint8_t kOnlyWhere = 100;
    if (version == 0) {
        skip(in, 3 * sizeof(std::uint32_t) + 1);  // width, height, channels, origin
        return skipCounted(in);
    }
    if (version == 1) return skipCounted(in);
    if (version > 9 && version != kOnlyWhere) throw std::runtime_error("an image of no known kind");
    if (version >= 6 && readAs<std::uint8_t>(in) != 0) return skipCounted(in);  // a file's name
    if (version == kOnlyWhere) return;
    if (readAs<std::uint8_t>(in) == 0)
        skipGrey(in, version);
    else
        skipColour(in, version);
}
}  // namespace

ObjectArchive::ObjectArchive(GzInput& in, FileOf file) : in_(in), file_(file) {}

mrpt::serialization::CSerializable::Ptr ObjectArchive::next() {
    const char here = 0;
    begin(&here);
    return ReadObject();
}

void ObjectArchive::nextInto(mrpt::serialization::CSerializable& object) {
    const char here = 0;
    begin(&here);
    ReadObject(&object);
}

void ObjectArchive::begin(const char* stack) {
    stack_ = stack;
    next_ = Next::Anything;
    movement_ = Movement::None;
    nameSize_ = oldNameSize_ = 0;
    counts_ = {};
    viewports_ = Viewports::None;
}

std::size_t ObjectArchive::read(void* data, std::size_t count) {
    checkDepth();
    if (next_ == Next::ImageVersion) {
        passOverImage(data, count);
        return count;
    }
    if (next_ == Next::ImageIsExternal) {
        std::memset(data, 0, count);
        next_ = Next::Anything;
        return count;
    }
    const std::size_t done = in_.Read(data, count);
    if (done < count || count == 0) return done;
    checkCount(data, count);
    foresee(data, count);
    return done;
}

void ObjectArchive::checkDepth() const {
    constexpr std::ptrdiff_t kMost = 1 << 20;
    const char here = 0;
    if (stack_ - &here > kMost) throw std::length_error("objects lie too deep in each other");
}

/** MRPT reads what is part of an object into the object, and how many elements it has into a
 *  variable of the function that reads: on the stack. */
void ObjectArchive::checkCount(const void* data, std::size_t bytes) {
    const std::uint64_t before = std::exchange(lastCount_, 1);
    const char here = 0;
    const auto* to = static_cast<const char*>(data);
    const bool isCount = (bytes == sizeof(std::uint32_t) || bytes == sizeof(std::uint16_t)) &&
                         std::less<>()(&here, to) && std::less<>()(to, stack_);
    if (counts_.left == 0 || !isCount) return;
    if (counts_.skip > 0) {
        --counts_.skip;
        return;
    }
    if (counts_.left != kAll) --counts_.left;
    std::uint32_t elements = 0;
    std::memcpy(&elements, data, bytes);
    if (counts_.floatsToo && isLikeAFloat(elements)) return;
    const std::uint64_t size = in_.getTotalBytesCount();
    std::uint64_t most = in_.compressed() ? counts_.most : size - in_.getPosition();
    if (file_ != FileOf::Scene)
        most = std::min(most, counts_.most);
    else if (in_.compressed())
        most += 2 * size;
    // Among them are numbers that count nothing: small ones, such as a kind or a size of letters.
    constexpr std::uint64_t kSmall = 4096;
    if (counts_.othersToo) most = std::max(most, kSmall);
    if (elements > most || elements * before > most)
        throw std::length_error("it claims more than the file can hold");
    lastCount_ = elements;
}

void ObjectArchive::foresee(const void* data, std::size_t count) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    if (next_ == Next::SimplemapVersion) {
        next_ = Next::Anything;
        if (bytes[0] == 0) {
            refused_ = "mrpt::maps::CSimpleMap of version 0";
            throw std::runtime_error("it holds " + refused_);
        }
    }
    if (movement_ == Movement::Method && count == sizeof(std::int32_t)) {
        std::int32_t method = 0;
        std::memcpy(&method, data, sizeof(method));
        movement_ = method == mrpt::obs::CActionRobotMovement2D::emOdometry ? Movement::Odometry
                                                                            : Movement::Pdf;
    }
    if (nameSize_ == count) foreseeClass({static_cast<const char*>(data), count});
    // A name's length has its highest bit set; in old files it has not, and three zeros follow.
    constexpr unsigned kNew = 0x80;
    const bool isZeros = count == 3 && bytes[0] == 0 && bytes[1] == 0 && bytes[2] == 0;
    nameSize_ = isZeros ? oldNameSize_ : 0;
    oldNameSize_ = 0;
    if (count != 1) return;
    (bytes[0] & kNew ? nameSize_ : oldNameSize_) = bytes[0] & ~kNew;
}

void ObjectArchive::foreseeClass(std::string_view name) {
    // Up to its end for MRPT, which takes it for a C string.
    const auto* known =
        mrpt::rtti::findRegisteredClass(std::string(name.substr(0, name.find('\0'))));
    checkViewport(known ? known->className : "nothing");
    if (!known) return;  // MRPT says so itself
    const std::string_view className = known->className;
    if (!isKnown(className, file_)) {
        refused_ = className;
        throw std::runtime_error("it holds " + refused_);
    }
    checkMovement(className);
    if (className == "mrpt::img::CImage") next_ = Next::ImageVersion;
    if (className == "mrpt::maps::CSimpleMap") next_ = Next::SimplemapVersion;
    const auto counts = countsIn(className, file_);
    const bool isIn =
        counts_.left == kAll && endsWith(className.substr(0, className.size() - 1), "::CMatrix");
    if (counts && !isIn) counts_ = *counts;
}

void ObjectArchive::checkMovement(std::string_view className) {
    constexpr std::string_view kPdf = "mrpt::poses::CPosePDF";
    const auto before = std::exchange(movement_, Movement::None);
    const bool fits = before == Movement::None ||
                      (before == Movement::Odometry && className == "mrpt::poses::CPose2D") ||
                      (before == Movement::Pdf && className.substr(0, kPdf.size()) == kPdf);
    if (!fits) throw std::runtime_error("a movement is of no known kind");
    if (className == "mrpt::obs::CActionRobotMovement2D") movement_ = Movement::Method;
}

/** What lies in a viewport is read by a function that its reader calls: deeper in the stack. */
void ObjectArchive::checkViewport(std::string_view className) {
    const char here = 0;
    const std::ptrdiff_t depth = stack_ - &here;
    if (viewports_ == Viewports::First) viewportDepth_ = depth;
    const bool isOfScene = viewports_ != Viewports::None && depth <= viewportDepth_;
    if (isOfScene && className != "mrpt::opengl::COpenGLViewport")
        throw std::runtime_error("where a viewport should be, it holds something else");
    if (isOfScene) viewports_ = Viewports::More;
    if (className == "mrpt::opengl::COpenGLScene") viewports_ = Viewports::First;
}

void ObjectArchive::passOverImage(void* version, std::size_t count) {
    if (in_.Read(version, count) != count) throw std::runtime_error("the file ends early");
    skipImage(in_, *static_cast<const std::uint8_t*>(version));
    // What MRPT writes of an image where it has no OpenCV: whether it is in another file.
    constexpr char kOnlyWhere = 100;
    std::memset(version, 0, count);
    *static_cast<char*>(version) = kOnlyWhere;
    next_ = Next::ImageIsExternal;
}
}  // namespace delio::io
