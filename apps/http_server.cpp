#include "http_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <sstream>
#include <utility>
#include <vector>

#include "delio/core/error.h"

namespace delio {
namespace {
using Clock = std::chrono::steady_clock;
constexpr std::size_t kLongestRequest = 8192;  // bytes
constexpr std::size_t kMostClients = 32;
constexpr auto kPatience = std::chrono::seconds(5);

const char* reasonOf(int status) {
    switch (status) {
        case 200:
            return "OK";
        case 204:
            return "No Content";
        case 400:
            return "Bad Request";
        case 403:
            return "Forbidden";
        case 405:
            return "Method Not Allowed";
        case 431:
            return "Request Header Fields Too Large";
        default:
            return "Not Found";
    }
}

std::string textOf(const HttpServer::Reply& reply) {
    return "HTTP/1.1 " + std::to_string(reply.status) + " " + reasonOf(reply.status) +
           "\r\nContent-Type: " + reply.type +
           "\r\nContent-Length: " + std::to_string(reply.body.size()) +
           "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
           "Connection: close\r\n\r\n" +
           reply.body;
}

/** The host that a request names, without its port; empty: none. */
std::string hostOf(const std::string& request) {
    std::istringstream lines(request);
    std::string line;
    while (std::getline(lines, line)) {
        std::string name = line.substr(0, 5);
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (name != "host:") continue;
        const auto begin = std::min(line.find_first_not_of(" \t", 5), line.size());
        return line.substr(begin, line.find_first_of(": \t\r", begin) - begin);
    }
    return "";
}
}  // namespace

struct HttpServer::Client {
    explicit Client(int connection) : file(connection) {}

    int file;
    Clock::time_point deadline = Clock::now() + kPatience;
    std::string request, reply;
    std::size_t sent = 0;  //!< bytes of the reply

    bool isAnswered() const { return !reply.empty() && sent == reply.size(); }
};

HttpServer::HttpServer(std::uint16_t port, Handler handler) : handler_(std::move(handler)) {
    listenTo(port);
    wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    thread_ = std::thread([this] { run(); });
}

HttpServer::~HttpServer() {
    const std::uint64_t one = 1;
    if (write(wake_, &one, sizeof(one)) == sizeof(one)) thread_.join();
    for (const auto& client : clients_) close(client.file);
    close(wake_);
    close(listener_);
}

void HttpServer::listenTo(std::uint16_t port) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const int yes = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_port = htons(port);
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(own);
    if (bind(listener_, reinterpret_cast<const sockaddr*>(&own), size) != 0 ||
        listen(listener_, kMostClients) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
        const std::string reason = std::strerror(errno);
        close(listener_);
        throw Error("cannot serve the map at port " + std::to_string(port) + ": " + reason +
                    "; choose another one with --serve");
    }
    port_ = ntohs(own.sin_port);
}

void HttpServer::run() {
    for (;;) {
        std::vector<pollfd> files{{wake_, POLLIN, 0}, {listener_, POLLIN, 0}};
        for (const auto& client : clients_)
            files.push_back(
                {client.file,
                 static_cast<short>(client.reply.empty() || client.isAnswered() ? POLLIN : POLLOUT),
                 0});
        constexpr int kCheck_ms = 1000;  // deadlines
        if (poll(files.data(), files.size(), kCheck_ms) < 0 && errno != EINTR) return;
        if (files[0].revents != 0) return;
        auto file = files.begin() + 2;
        for (auto client = clients_.begin(); client != clients_.end(); ++file) {
            if (serve(*client, file->revents) && Clock::now() < client->deadline) {
                ++client;
                continue;
            }
            close(client->file);
            client = clients_.erase(client);
        }
        if (files[1].revents != 0) accept();
    }
}

void HttpServer::accept() {
    const int file = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (file < 0) return;
    if (clients_.size() < kMostClients)
        clients_.emplace_back(file);
    else
        close(file);
}

bool HttpServer::serve(Client& client, short events) {
    if (events == 0) return true;
    if (client.isAnswered()) {
        // What is not read would take the answer from the client. It closes next.
        char rest[4096];
        const ssize_t count = recv(client.file, rest, sizeof(rest), 0);
        return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
    }
    if (client.reply.empty()) return receive(client);
    const ssize_t sent = send(client.file, client.reply.data() + client.sent,
                              client.reply.size() - client.sent, MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    client.sent += static_cast<std::size_t>(sent);
    client.deadline = Clock::now() + kPatience;
    if (client.isAnswered()) shutdown(client.file, SHUT_WR);
    return true;
}

bool HttpServer::receive(Client& client) {
    char bytes[4096];
    const ssize_t count = recv(client.file, bytes, sizeof(bytes), 0);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) return false;
    client.request.append(bytes, static_cast<std::size_t>(count));
    if (client.request.size() > kLongestRequest)
        client.reply = textOf({431, "text/plain; charset=utf-8", "the request is too long\n"});
    else if (client.request.find("\r\n\r\n") != std::string::npos)
        client.reply = textOf(replyTo(client.request));
    return true;
}

HttpServer::Reply HttpServer::replyTo(const std::string& request) const {
    std::istringstream words(request.substr(0, request.find("\r\n")));
    std::string method, target, version;
    words >> method >> target >> version;
    const std::string type = "text/plain; charset=utf-8";
    if (version.rfind("HTTP/1.", 0) != 0 || target.empty() || target[0] != '/')
        return {400, type, "not a request of HTTP/1.1\n"};
    // A page of another site whose name leads here must not read the map.
    const std::string host = hostOf(request);
    if (host != "127.0.0.1" && host != "localhost")
        return {403, type, "open http://localhost or http://127.0.0.1\n"};
    if (method != "GET") return {405, type, "GET only\n"};
    return handler_(target);
}
}  // namespace delio
