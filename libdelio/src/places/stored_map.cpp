#include "delio/places/stored_map.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/voxel_grid.h"
#include "delio/core/error.h"
#include "delio/files/output.h"
#include "files/input_file.h"
#include "files/names.h"
#include "formats/number_line.h"
#include "places/bytes.h"
#include "places/descriptor.h"
#include "places/tiles.h"

namespace delio {
namespace {
// magic, version, offset, bytes, unpacked bytes and checksum of the index, size of the file, and
// the checksum of all that.
constexpr std::array<char, 8> kMagic{'D', 'e', 'L', 'i', 'O', 'm', 'a', 'p'};
constexpr std::size_t kHead = 8 + 4 + 8 + 8 + 8 + 4 + 8 + 4;
constexpr std::uint32_t kDrivesOnly = 1;  // version without CloudOrigin
constexpr std::uint32_t kImported = 2;    // version without visits
constexpr double kCell_m = places::HeightImage::kCell_m;

std::uint32_t checksumOf(const std::uint8_t* bytes, std::size_t count) {
    return static_cast<std::uint32_t>(crc32_z(0, bytes, count));
}

void put(ByteWriter& bytes, const Matrix6& symmetric) {
    for (Eigen::Index i = 0; i < 6; ++i)
        for (Eigen::Index k = i; k < 6; ++k) bytes.put(symmetric(i, k));
}
Matrix6 getSymmetric(ByteReader& bytes) {
    Matrix6 symmetric;
    for (Eigen::Index i = 0; i < 6; ++i)
        for (Eigen::Index k = i; k < 6; ++k)
            symmetric(i, k) = symmetric(k, i) = bytes.get<double>();
    return symmetric;
}

void put(ByteWriter& bytes, const graph::PoseGraph& graph) {
    bytes.put<std::uint64_t>(graph.poses().size());
    for (const auto& pose : graph.poses()) bytes.put(pose);
    bytes.put<std::uint64_t>(graph.edges().size());
    for (const auto& edge : graph.edges()) {
        bytes.put<std::uint64_t>(edge.from);
        bytes.put<std::uint64_t>(edge.to);
        bytes.put(edge.increment.pose);
        put(bytes, edge.increment.covariance);
    }
}
graph::PoseGraph getGraph(ByteReader& bytes) {
    graph::PoseGraph graph;
    for (auto left = bytes.get<std::uint64_t>(); left > 0; --left) graph.addNode(bytes.getPose());
    for (auto left = bytes.get<std::uint64_t>(); left > 0; --left) {
        graph::Edge edge;
        edge.from = bytes.get<std::uint64_t>();
        edge.to = bytes.get<std::uint64_t>();
        edge.increment.pose = bytes.getPose();
        edge.increment.covariance = getSymmetric(bytes);
        graph.addEdge(edge);
    }
    return graph;
}

void put(ByteWriter& bytes, const places::Submap& submap) {
    for (const auto node : {submap.first, submap.key, submap.last}) bytes.put<std::uint64_t>(node);
    for (const double value :
         {submap.driven.path_m, submap.driven.variance_m2, submap.driven.variance_rad2})
        bytes.put(value);
    bytes.put(isometry(submap.level, Eigen::Vector3d::Zero()));
}
places::Submap getSubmap(ByteReader& bytes, std::size_t nodes) {
    places::Submap submap;
    for (auto* node : {&submap.first, &submap.key, &submap.last}) {
        *node = bytes.get<std::uint64_t>();
        if (*node >= nodes) throw std::out_of_range("node");
    }
    for (auto* value :
         {&submap.driven.path_m, &submap.driven.variance_m2, &submap.driven.variance_rad2})
        *value = bytes.get<double>();
    submap.level = bytes.getPose().linear();
    submap.points.resize(3, 0);
    return submap;
}

void put(ByteWriter& bytes, const earth::Georeference& place) {
    for (const double value :
         {place.origin.latitude_deg, place.origin.longitude_deg, place.origin.height_m})
        bytes.put(value);
    bytes.put(place.enuFromMap);
    put(bytes, place.covariance);
}
earth::Georeference getGeoreference(ByteReader& bytes) {
    earth::Georeference place;
    for (auto* value :
         {&place.origin.latitude_deg, &place.origin.longitude_deg, &place.origin.height_m})
        *value = bytes.get<double>();
    if (!earth::isPlausible(place.origin)) throw std::out_of_range("origin");
    place.enuFromMap = bytes.getPose();
    place.covariance = getSymmetric(bytes);
    return place;
}

void put(ByteWriter& bytes, const CloudOrigin& cloud) {
    bytes.put<std::uint64_t>(cloud.tiles);
    for (const double value : cloud.offset) bytes.put(value);
    bytes.put(cloud.wkt);
}
CloudOrigin getCloudOrigin(ByteReader& bytes) {
    CloudOrigin cloud;
    cloud.tiles = bytes.get<std::uint64_t>();
    for (double& value : cloud.offset) value = bytes.get<double>();
    cloud.wkt = bytes.getText();
    return cloud;
}

void put(ByteWriter& bytes, const std::vector<Visit>& visits) {
    bytes.put<std::uint64_t>(visits.size());
    for (const auto& visit : visits) {
        bytes.put(visit.name);
        bytes.put(visit.begin_s);
        bytes.put(visit.end_s);
    }
}

void put(ByteWriter& bytes, const std::vector<PointLayer>& layers) {
    bytes.put<std::uint64_t>(layers.size());
    for (const auto& layer : layers) {
        for (const auto number : {layer.first, layer.last, layer.against, layer.doubted})
            bytes.put(number);
        bytes.put<std::uint8_t>(layer.confirmed);
        put(bytes, layer.points);
    }
}
std::vector<PointLayer> getLayers(ByteReader& bytes, std::size_t visits) {
    std::vector<PointLayer> layers;
    for (auto left = bytes.get<std::uint64_t>(); left > 0; --left) {
        PointLayer layer;
        for (auto* number : {&layer.first, &layer.last, &layer.against, &layer.doubted})
            *number = bytes.get<std::uint32_t>();
        if (std::max({layer.first, layer.last, layer.doubted}) >= visits)
            throw std::out_of_range("visit");
        layer.confirmed = bytes.get<std::uint8_t>() != 0;
        layer.points = getPoints(bytes);
        layers.push_back(std::move(layer));
    }
    return layers;
}

/** Points of all layers that `isWanted`. */
template <typename Predicate>
Eigen::Matrix3Xf pointsOf(const std::vector<PointLayer>& layers, const Predicate& isWanted) {
    std::vector<Eigen::Matrix3Xf> parts;
    for (const auto& layer : layers)
        if (isWanted(layer)) parts.push_back(layer.points);
    return places::together(parts);
}

/** Centres of cells, as whole numbers of half a cell. */
void putCentres(ByteWriter& bytes, const Eigen::Matrix2Xd& centres) {
    std::vector<std::int16_t> halves;
    for (Eigen::Index i = 0; i < centres.cols(); ++i)
        for (Eigen::Index k = 0; k < 2; ++k)
            halves.push_back(static_cast<std::int16_t>(std::lround(2 * centres(k, i) / kCell_m)));
    bytes.putAll(halves.data(), halves.size());
}
Eigen::Matrix2Xd getCentres(ByteReader& bytes) {
    const auto halves = bytes.getAll<std::int16_t>();
    Eigen::Matrix2Xd centres(2, static_cast<Eigen::Index>(halves.size() / 2));
    for (Eigen::Index i = 0; i < centres.cols(); ++i)
        for (Eigen::Index k = 0; k < 2; ++k)
            centres(k, i) = kCell_m / 2 * halves[static_cast<std::size_t>(2 * i + k)];
    return centres;
}

void put(ByteWriter& bytes, const places::Descriptor& descriptor) {
    const Eigen::VectorXf weights = descriptor.walls.weights().cast<float>();
    bytes.putAll(weights.data(), static_cast<std::size_t>(weights.size()));
    putCentres(bytes, descriptor.image.cells());
    bytes.putAll(descriptor.image.bands().data(), descriptor.image.bands().size());
    putCentres(bytes, descriptor.image.grounds());
    const auto& heights = descriptor.image.heights();
    bytes.putAll(heights.data(), heights.size());
}
places::Descriptor getSketch(ByteReader& bytes) {
    const auto weights = bytes.getAll<float>();
    const Eigen::VectorXd azimuths =
        Eigen::Map<const Eigen::VectorXf>(weights.data(), static_cast<Eigen::Index>(weights.size()))
            .cast<double>();
    const auto cells = getCentres(bytes);
    auto bands = bytes.getAll<std::uint8_t>();
    auto grounds = getCentres(bytes);
    auto heights = bytes.getAll<double>();
    if (azimuths.size() != places::WallOrientations::kBins ||
        bands.size() != static_cast<std::size_t>(cells.cols()) ||
        heights.size() != static_cast<std::size_t>(grounds.cols()))
        throw std::out_of_range("descriptor");
    return {places::WallOrientations::ofWeights(azimuths),
            places::HeightImage(cells, std::move(bands), std::move(grounds), std::move(heights))};
}
}  // namespace

Eigen::Matrix3Xf validPoints(const std::vector<PointLayer>& layers) {
    return pointsOf(layers, [](const PointLayer& layer) { return layer.isValid(); });
}

Visit visitOf(const StoredDrive& drive) {
    constexpr double kFirstUnix_s = 5e8;  // smaller stamps count from the start of the drive
    const auto& stamps = drive.stamps_s;
    if (stamps.empty() || stamps.front() < kFirstUnix_s) return {drive.name};
    return {drive.name, stamps.front(), stamps.back()};
}

/** Packs parts one behind the other. */
class StoredMap::Writer {
 public:
    Writer(std::ostream& out, std::uint64_t offset) : out_(out), end_(offset) {}

    Part add(const ByteWriter& bytes) {
        const auto& plain = bytes.bytes();
        uLongf size = compressBound(plain.size());
        std::vector<std::uint8_t> packed(size);
        if (compress2(packed.data(), &size, plain.data(), plain.size(), Z_DEFAULT_COMPRESSION) !=
            Z_OK)
            throw Error("cannot compress a part of the stored map");
        const Part part{end_, size, plain.size(), checksumOf(packed.data(), size)};
        out_.write(reinterpret_cast<const char*>(packed.data()),
                   static_cast<std::streamsize>(size));
        end_ += size;
        return part;
    }
    std::uint64_t end() const { return end_; }

    static void put(ByteWriter& bytes, const Part& part) {
        bytes.put(part.offset);
        bytes.put(part.bytes);
        bytes.put(part.unpacked);
        bytes.put(part.checksum);
    }
    static Part get(ByteReader& bytes) {
        Part part;
        part.offset = bytes.get<std::uint64_t>();
        part.bytes = bytes.get<std::uint64_t>();
        part.unpacked = bytes.get<std::uint64_t>();
        part.checksum = bytes.get<std::uint32_t>();
        return part;
    }

 private:
    std::ostream& out_;
    std::uint64_t end_;
};

void StoredMap::save(const MapContent& content, const std::string& path) {
    io::replaceFile(path, [&](const std::string& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        if (!out) throw Error("cannot write '" + path + "': " + std::strerror(errno));
        out.seekp(kHead);
        Writer writer(out, kHead);
        ByteWriter index;
        put(index, content.graph);
        index.put<std::uint64_t>(content.drives.size());
        for (const auto& drive : content.drives) {
            index.put(drive.name);
            index.put<std::uint64_t>(drive.firstNode);
            index.putAll(drive.stamps_s.data(), drive.stamps_s.size());
        }
        index.put<std::uint64_t>(content.submaps.size());
        for (std::size_t i = 0; i < content.submaps.size() && out; ++i) {
            put(index, content.submaps[i]);
            ByteWriter descriptor, points;
            put(descriptor, content.descriptor(i));
            if (content.layers)
                put(points, content.layers(i));
            else
                put(points, content.points(i));
            Writer::put(index, writer.add(descriptor));
            Writer::put(index, writer.add(points));
        }
        const bool isUpdated = static_cast<bool>(content.layers);
        if (content.cloud || isUpdated) index.put<std::uint8_t>(content.georeference.has_value());
        if (content.georeference) put(index, *content.georeference);
        if (isUpdated) index.put<std::uint8_t>(content.cloud.has_value());
        if (content.cloud) put(index, *content.cloud);
        if (isUpdated) put(index, content.visits);
        const Part part = writer.add(index);
        ByteWriter head;
        for (const char letter : kMagic) head.put(letter);
        head.put<std::uint32_t>(isUpdated ? kVersion : content.cloud ? kImported : kDrivesOnly);
        Writer::put(head, part);
        head.put(writer.end());
        head.put(checksumOf(head.bytes().data(), head.bytes().size()));
        out.seekp(0);
        out.write(reinterpret_cast<const char*>(head.bytes().data()), kHead);
        out.close();
        return static_cast<bool>(out);
    });
}

StoredMap::StoredMap(const std::string& path) : path_(path) {
    file_ = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // no waiting for a pipe
    struct stat status {};
    std::vector<std::uint8_t> head(kHead);
    if (file_ < 0) throw Error("cannot read '" + path + "': " + std::strerror(errno));
    try {
        const bool whole = fstat(file_, &status) == 0 &&
                           pread(file_, head.data(), kHead, 0) == static_cast<ssize_t>(kHead);
        if (!whole || !std::equal(kMagic.begin(), kMagic.end(), head.begin()))
            throw Error("'" + path + "' is not a stored map");
        size_ = static_cast<std::uint64_t>(status.st_size);
        ByteReader reader(head);
        for (std::size_t i = 0; i < kMagic.size(); ++i) reader.get<char>();
        const auto version = reader.get<std::uint32_t>();
        if (version < kDrivesOnly || version > kVersion)
            throw Error("'" + path + "' is a stored map with format version " +
                        std::to_string(version) + "; this program reads versions up to " +
                        std::to_string(kVersion));
        const Part index = Writer::get(reader);
        const auto size = reader.get<std::uint64_t>();
        if (reader.get<std::uint32_t>() != checksumOf(head.data(), kHead - 4))
            damaged("wrong checksum of the header");
        if (size > size_) damaged("the file is cut off");
        readIndex(index, version);
    } catch (...) {
        close(file_);
        throw;
    }
}

StoredMap::~StoredMap() { close(file_); }

void StoredMap::damaged(const std::string& how) const {
    throw Error("the stored map '" + path_ + "' is damaged: " + how);
}

std::vector<std::uint8_t> StoredMap::read(const Part& part) const {
    if (part.offset > size_ || part.bytes > size_ - part.offset) damaged("the file is cut off");
    if (part.unpacked > std::min(io::kMostBytes, 2000 * part.bytes + 100))
        damaged("a part is too large");
    std::vector<std::uint8_t> packed(part.bytes), plain(part.unpacked);
    for (std::size_t done = 0; done < packed.size();) {
        const auto count = pread(file_, packed.data() + done, packed.size() - done,
                                 static_cast<off_t>(part.offset + done));
        if (count <= 0) damaged("the file cannot be read");
        done += static_cast<std::size_t>(count);
    }
    if (checksumOf(packed.data(), packed.size()) != part.checksum)
        damaged("wrong checksum of a part");
    uLongf size = plain.size();
    if (uncompress(plain.data(), &size, packed.data(), packed.size()) != Z_OK ||
        size != plain.size())
        damaged("a part cannot be decompressed");
    return plain;
}

void StoredMap::readIndex(const Part& index, std::uint32_t version) {
    const auto bytes = read(index);
    ByteReader reader(bytes);
    try {
        graph_ = getGraph(reader);
        for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
            StoredDrive drive;
            drive.name = reader.getText();
            // Files and folders are called after it.
            if (!io::isFileName(drive.name)) throw std::out_of_range("name");
            drive.firstNode = reader.get<std::uint64_t>();
            drive.stamps_s = reader.getAll<double>();
            const auto nodes = graph_.poses().size();
            if (drive.firstNode > nodes || drive.stamps_s.size() > nodes - drive.firstNode)
                throw std::out_of_range("drive");
            drives_.push_back(std::move(drive));
        }
        for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
            submaps_.push_back(getSubmap(reader, graph_.poses().size()));
            descriptors_.push_back(Writer::get(reader));
            clouds_.push_back(Writer::get(reader));
        }
        // A map of drives without a georeference ends here.
        if (version != kDrivesOnly ? reader.get<std::uint8_t>() != 0 : !reader.atEnd())
            georeference_ = getGeoreference(reader);
        isUpdated_ = version == kVersion;
        if (isUpdated_ ? reader.get<std::uint8_t>() != 0 : version == kImported)
            cloud_ = getCloudOrigin(reader);
        if (cloud_ && cloud_->tiles > submaps_.size()) throw std::out_of_range("tiles");
        if (isUpdated_)
            readVisits(reader);
        else
            visits_ = visitsOfDrives();
    } catch (const std::exception&) {
        damaged("invalid index");
    }
    level_ = places::levelFrames(submaps_, graph_.poses());
}

void StoredMap::readVisits(ByteReader& reader) {
    for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
        Visit visit;
        visit.name = reader.getText();
        visit.begin_s = reader.get<double>();
        visit.end_s = reader.get<double>();
        visits_.push_back(std::move(visit));
    }
}

std::vector<Visit> StoredMap::visitsOfDrives() const {
    std::vector<Visit> visits;
    if (cloud_ && cloud_->tiles > 0) visits.push_back({"cloud"});
    for (const auto& drive : drives_) visits.push_back(delio::visitOf(drive));
    return visits;
}

std::uint32_t StoredMap::visitOf(const places::Submap& submap) const {
    std::uint32_t visit = cloud_ && cloud_->tiles > 0 ? 1 : 0;
    for (std::size_t i = 0; i < drives_.size(); ++i, ++visit)
        if (submap.key >= drives_[i].firstNode &&
            submap.key - drives_[i].firstNode < drives_[i].stamps_s.size())
            return visit;
    return 0;
}

std::size_t StoredMap::visitAt(const std::string& time) const {
    const auto unix_s = io::unixTimeIn(time);
    if (!unix_s)
        throw Error("'" + time +
                    "' is not a time: give 2026-11-28T06:00:00Z, a date, or Unix seconds");
    std::optional<std::size_t> found;
    std::optional<double> earliest_s;
    for (std::size_t i = 0; i < visits_.size(); ++i) {
        const double begin_s = visits_[i].begin_s;
        if (begin_s > 0 && !earliest_s) earliest_s = begin_s;
        // Visits without a time at the map's start were before all others.
        if (begin_s > 0 ? begin_s <= *unix_s : !earliest_s) found = i;
    }
    if (!earliest_s)
        throw Error("the visits of the map '" + path_ +
                    "' have no times: the stamps of their recordings are not Unix times");
    if (!found)
        throw Error("the map '" + path_ + "' begins at " + io::dateOf(*earliest_s) +
                    ": there is no map before that");
    return *found;
}

io::Trajectory StoredMap::trajectory(const StoredDrive& drive) const {
    const auto first = graph_.poses().begin() + static_cast<std::ptrdiff_t>(drive.firstNode);
    return {{first, first + static_cast<std::ptrdiff_t>(drive.stamps_s.size())}, drive.stamps_s};
}

places::Descriptor StoredMap::descriptor(std::size_t submap) const {
    const auto bytes = read(descriptors_[submap]);
    ByteReader reader(bytes);
    try {
        return getSketch(reader);
    } catch (const std::out_of_range&) {
        damaged("invalid descriptor");
    }
}

Eigen::Matrix3Xf StoredMap::points(std::size_t submap) const { return validPoints(layers(submap)); }

std::vector<PointLayer> StoredMap::layers(std::size_t submap) const {
    const auto bytes = read(clouds_[submap]);
    ByteReader reader(bytes);
    try {
        if (isUpdated_) return getLayers(reader, visits_.size());
        PointLayer layer;
        if (!visits_.empty()) layer.first = layer.last = visitOf(submaps_[submap]);
        layer.points = getPoints(reader);
        return {layer};
    } catch (const std::out_of_range&) {
        damaged("invalid points");
    }
}

Eigen::Matrix3Xf StoredMap::surroundings(std::size_t submap) const {
    if (!cloud_ || submap >= cloud_->tiles) return points(submap);
    const std::vector<Eigen::Isometry3d> tiles(
        level_.begin(), level_.begin() + static_cast<std::ptrdiff_t>(cloud_->tiles));
    return places::surroundings(submap, tiles, [this](std::size_t i) { return points(i); });
}

Eigen::Matrix3Xf StoredMap::cloud(double spacing, std::optional<std::size_t> visit) const {
    const auto isWanted = [&](const PointLayer& layer) {
        return visit ? layer.isValidAt(*visit) : layer.isValid();
    };
    std::vector<Eigen::Matrix3Xf> parts;
    for (std::size_t i = 0; i < submaps_.size(); ++i)
        parts.emplace_back(level_[i].cast<float>() * pointsOf(layers(i), isWanted));
    return firstOfVoxels(places::together(parts), spacing);
}

MapContent StoredMap::content() const {
    MapContent content{graph_,
                       drives_,
                       submaps_,
                       [this](std::size_t i) { return descriptor(i); },
                       [this](std::size_t i) { return points(i); },
                       georeference_,
                       cloud_};
    if (!isUpdated_) return content;
    content.visits = visits_;
    content.layers = [this](std::size_t i) { return layers(i); };
    return content;
}
}  // namespace delio
