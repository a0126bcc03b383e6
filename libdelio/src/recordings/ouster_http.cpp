#include "ouster_http.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "delio/core/error.h"

namespace delio::io {
namespace {
using Clock = std::chrono::steady_clock;
constexpr auto kPatience = std::chrono::seconds(3);
constexpr std::size_t kLongest = 4 << 20;  // bytes
constexpr const char* kPath = "/api/v1/sensor/metadata";

[[noreturn]] void failBySystem() { throw Error(std::strerror(errno)); }

bool isToBeTriedAgain() { return errno == EAGAIN || errno == EINTR; }

/** Closed at its end. */
struct Socket {
    Socket() : file(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {}
    ~Socket() { close(file); }
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;

    void waitFor(short events) const {
        pollfd one{file, events, 0};
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
        if (left.count() <= 0 || poll(&one, 1, static_cast<int>(left.count())) == 0)
            throw Error("no answer within 3 s");
    }

    int file;
    Clock::time_point deadline = Clock::now() + kPatience;
};

void connectTo(const Socket& socket, std::uint32_t address, std::uint16_t port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(address);
    to.sin_port = htons(port);
    if (connect(socket.file, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0) return;
    if (errno != EINPROGRESS) failBySystem();
    socket.waitFor(POLLOUT);
    int fault = 0;
    socklen_t size = sizeof(fault);
    getsockopt(socket.file, SOL_SOCKET, SO_ERROR, &fault, &size);
    if (fault != 0) throw Error(std::strerror(fault));
}

void sendAll(const Socket& socket, const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        socket.waitFor(POLLOUT);
        const ssize_t sent = send(socket.file, text.data() + at, text.size() - at, MSG_NOSIGNAL);
        if (sent < 0 && !isToBeTriedAgain()) failBySystem();
        if (sent > 0) at += static_cast<std::size_t>(sent);
    }
}

/** All until the other side closes. */
std::string receiveAll(const Socket& socket) {
    std::string text;
    char bytes[16384];
    while (text.size() < kLongest) {
        socket.waitFor(POLLIN);
        const ssize_t count = recv(socket.file, bytes, sizeof(bytes), 0);
        if (count == 0) return text;
        if (count < 0 && !isToBeTriedAgain()) failBySystem();
        if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
    }
    throw Error("the answer is too long");
}

std::string hostOf(std::uint32_t address, std::uint16_t port) {
    char text[INET_ADDRSTRLEN];
    const in_addr raw{htonl(address)};
    inet_ntop(AF_INET, &raw, text, sizeof(text));
    return text + (port == 80 ? "" : ":" + std::to_string(port));
}
}  // namespace

std::string ousterJsonFrom(std::uint32_t address, std::uint16_t port) {
    const std::string host = hostOf(address, port);
    try {
        const Socket socket;
        connectTo(socket, address, port);
        // Of 1.0: the answer ends with the connection and comes in one piece.
        sendAll(socket, std::string("GET ") + kPath + " HTTP/1.0\r\nHost: " + host +
                            "\r\nAccept: application/json\r\n\r\n");
        const std::string answer = receiveAll(socket);
        const auto status = answer.find(' ');
        if (answer.rfind("HTTP/1.", 0) != 0 || answer.compare(status, 5, " 200 ") != 0)
            throw Error("the answer is '" + answer.substr(0, answer.find_first_of("\r\n")) + "'");
        const auto head = answer.find("\r\n\r\n");
        if (head == answer.npos) throw Error("the answer is cut off");
        return answer.substr(head + 4);
    } catch (const Error& e) {
        throw Error("the sensor's json cannot be read from http://" + host + kPath + " (" +
                    e.what() + ")");
    }
}
}  // namespace delio::io
