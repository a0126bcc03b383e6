#include "map_server.h"

#include <cstring>
#include <sstream>
#include <utility>

#include "delio/core/text.h"
#include "delio/map/page.h"

namespace delio {
namespace {
constexpr std::size_t kMostPoints = 50000;  // of a reply, 16 bytes each

/** What a viewer has: "?generation=1&points=200&poses=3". What is not understood is 0. */
LiveMap::Seen seenIn(const std::string& target) {
    LiveMap::Seen seen;
    std::istringstream terms(target.substr(std::min(target.find('?'), target.size() - 1) + 1));
    for (std::string term; std::getline(terms, term, '&');) {
        const auto equals = term.find('=');
        if (equals == term.npos) continue;
        const std::string name = term.substr(0, equals);
        const std::size_t value = std::strtoull(term.c_str() + equals + 1, nullptr, 10);
        if (name == "generation") seen.generation = static_cast<std::uint32_t>(value);
        if (name == "points") seen.points = value;
        if (name == "poses") seen.poses = value;
    }
    return seen;
}

void append(float number, std::string& bytes) {
    char raw[sizeof(number)];
    std::memcpy(raw, &number, sizeof(number));
    bytes.append(raw, sizeof(raw));
}

/** A line of JSON; then x, y, z of each pose and x, y, z, height above the ground of each point as
 *  32-bit floats. */
std::string textOf(const LiveMap::News& news) {
    const auto list = [](const Eigen::Vector3d& v) {
        return "[" + fixed(v.x(), 3) + "," + fixed(v.y(), 3) + "," + fixed(v.z(), 3) + "]";
    };
    std::string weak;
    for (const auto& axis : news.weakAxes.colwise())
        weak += (weak.empty() ? "" : ",") + list(axis.cast<double>());
    std::string text = "{\"generation\":" + std::to_string(news.from.generation) +
                       ",\"first\":" + std::to_string(news.from.points) +
                       ",\"points\":" + std::to_string(news.points.size()) +
                       ",\"all\":" + std::to_string(news.allPoints) +
                       ",\"firstPose\":" + std::to_string(news.from.poses) +
                       ",\"poses\":" + std::to_string(news.trajectory.size()) +
                       ",\"scans\":" + std::to_string(news.scans) +
                       ",\"vehicle\":" + list(news.vehicle.translation()) + ",\"weakAxes\":[" +
                       weak + "],\"ended\":" + (news.isEnded ? "true" : "false") + "}\n";
    for (const auto& place : news.trajectory)
        for (const float number : place) append(number, text);
    for (const auto& point : news.points) {
        for (const float number : point.position) append(number, text);
        append(point.aboveGround, text);
    }
    return text;
}
}  // namespace

MapServer::MapServer(std::uint16_t port, std::shared_ptr<const LiveMap> map,
                     const std::string& title)
    : map_(std::move(map)),
      page_(map::livePage(title)),
      server_(port, [this](const std::string& target) { return replyTo(target); }) {}

HttpServer::Reply MapServer::replyTo(const std::string& target) const {
    const std::string path = target.substr(0, target.find('?'));
    if (path == "/") return {200, "text/html; charset=utf-8", page_};
    if (path == "/live")
        return {200, "application/octet-stream",
                textOf(map_->newsSince(seenIn(target), kMostPoints))};
    if (path == "/favicon.ico") return {204, "image/x-icon", ""};
    return {404, "text/plain; charset=utf-8", "no such page; the map is at /\n"};
}
}  // namespace delio
