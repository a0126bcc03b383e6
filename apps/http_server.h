#pragma once
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <thread>

namespace delio {
/** Answers GET requests of programs on this machine, in a thread of its own. It waits for no
 * client: one that sends or reads nothing for some seconds is left, and so are those that are too
 * many. */
class HttpServer {
 public:
    struct Reply {
        int status = 404;
        std::string type = "text/plain; charset=utf-8", body;
    };
    /** Gets the target of a request ("/live?points=3"). Called by the server's thread. */
    using Handler = std::function<Reply(const std::string&)>;

    /** `port`: of 127.0.0.1; 0: any free one. Throws Error where it is in use. */
    HttpServer(std::uint16_t port, Handler handler);
    ~HttpServer();
    HttpServer(const HttpServer&) = delete;
    HttpServer& operator=(const HttpServer&) = delete;

    std::uint16_t port() const { return port_; }

 private:
    struct Client;

    void listenTo(std::uint16_t port);
    void run();
    void accept();
    /** False where the client is done. */
    bool serve(Client& client, short events);
    bool receive(Client& client);
    Reply replyTo(const std::string& request) const;

    Handler handler_;
    int listener_ = -1, wake_ = -1;
    std::uint16_t port_ = 0;
    std::list<Client> clients_;
    std::thread thread_;
};
}  // namespace delio
