#pragma once
#include <poll.h>

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "udp_sender.h"

/** Both ends of HTTP on loopback. */
namespace delio::test {
/** A client's connection to 127.0.0.1. */
class HttpClient {
 public:
    explicit HttpClient(std::uint16_t port)
        : file_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        const sockaddr_in to = loopback("127.0.0.1", port);
        isConnected_ = connect(file_, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0;
        const timeval most{20, 0};
        setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof(most));
    }
    ~HttpClient() { close(file_); }
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    bool isConnected() const { return isConnected_; }
    void send(const std::string& text) const {
        for (std::size_t at = 0; at < text.size();) {
            const ssize_t sent = ::send(file_, text.data() + at, text.size() - at, MSG_NOSIGNAL);
            if (sent <= 0) return;
            at += static_cast<std::size_t>(sent);
        }
    }
    /** All until the other side closes, or nothing comes for 20 seconds. */
    std::string receive() const {
        std::string text;
        char bytes[65536];
        for (;;) {
            const ssize_t count = recv(file_, bytes, sizeof(bytes), 0);
            if (count <= 0) return text;
            text.append(bytes, static_cast<std::size_t>(count));
        }
    }

 private:
    int file_;
    bool isConnected_ = false;
};

/** The whole answer; empty: no connection. */
inline std::string httpGet(std::uint16_t port, const std::string& target,
                           const std::string& host = "localhost") {
    const HttpClient client(port);
    client.send("GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    return client.receive();
}

/** A server that answers each request with the same body. */
class HttpEnd {
 public:
    /** Empty `body`: it never answers. */
    explicit HttpEnd(std::string body, const std::string& status = "200 OK")
        : answer_(body.empty() ? ""
                               : "HTTP/1.1 " + status + "\r\nConnection: close\r\n\r\n" + body),
          file_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        const sockaddr_in own = loopback("127.0.0.1", 0);
        bind(file_, reinterpret_cast<const sockaddr*>(&own), sizeof(own));
        listen(file_, 8);
        thread_ = std::thread([this] { run(); });
    }
    ~HttpEnd() {
        isEnding_ = true;
        thread_.join();
        close(file_);
    }
    HttpEnd(const HttpEnd&) = delete;
    HttpEnd& operator=(const HttpEnd&) = delete;

    std::uint16_t port() const {
        sockaddr_in own{};
        socklen_t size = sizeof(own);
        getsockname(file_, reinterpret_cast<sockaddr*>(&own), &size);
        return ntohs(own.sin_port);
    }
    std::vector<std::string> requests() const {
        const std::lock_guard lock(mutex_);
        return requests_;
    }

 private:
    void run() {
        std::vector<int> silent;
        while (!isEnding_) {
            pollfd one{file_, POLLIN, 0};
            if (poll(&one, 1, 20) <= 0) continue;
            const int client = accept(file_, nullptr, nullptr);
            char bytes[4096];
            const ssize_t count = recv(client, bytes, sizeof(bytes), 0);
            {
                const std::lock_guard lock(mutex_);
                requests_.emplace_back(bytes, count > 0 ? static_cast<std::size_t>(count) : 0);
            }
            if (answer_.empty()) {
                silent.push_back(client);
                continue;
            }
            if (send(client, answer_.data(), answer_.size(), MSG_NOSIGNAL) < 0) continue;
            close(client);
        }
        for (const int client : silent) close(client);
    }

    std::string answer_;
    int file_;
    mutable std::mutex mutex_;
    std::vector<std::string> requests_;
    std::atomic<bool> isEnding_{false};
    std::thread thread_;
};
}  // namespace delio::test
