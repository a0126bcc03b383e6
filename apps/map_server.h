#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "http_server.h"
#include "live_map.h"

namespace delio {
/** Serves a map that grows to browsers on this machine: the page, and what is new for it. */
class MapServer {
 public:
    /** Throws Error where the port is in use, or three.js is missing. */
    MapServer(std::uint16_t port, std::shared_ptr<const LiveMap> map, const std::string& title);

    std::string address() const {
        return "http://127.0.0.1:" + std::to_string(server_.port()) + "/";
    }

 private:
    HttpServer::Reply replyTo(const std::string& target) const;

    std::shared_ptr<const LiveMap> map_;
    std::string page_;
    HttpServer server_;
};
}  // namespace delio
