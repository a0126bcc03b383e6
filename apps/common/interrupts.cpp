#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <thread>

#include "cli.h"
#include "delio/core/error.h"

namespace delio::cli {
namespace {
// State used by the signal handler.
volatile std::sig_atomic_t isCaught = 0, isRequested = 0;
std::atomic<std::int64_t> requested_ms{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
std::atomic<int> wakeUp{-1};  // written to at the first signal

std::int64_t now_ms() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{1000} * now.tv_sec + now.tv_nsec / 1'000'000;
}

void onSignal(int) {
    // timeout(1), and who signals a process and its group, sends each signal twice.
    constexpr std::int64_t kOne_ms = 500;
    const bool isSecond = isRequested != 0 && now_ms() - requested_ms > kOne_ms;
    if (isCaught == 0 || isSecond) _exit(kExitInterrupted);
    if (isRequested != 0) return;
    requested_ms = now_ms();
    isRequested = 1;
    const int before = errno;
    if (wakeUp >= 0 && write(wakeUp, "", 1) < 0) errno = before;
}

void install(int signal, bool evenIfIgnored) {
    struct sigaction action {
    }, now{};
    sigaction(signal, nullptr, &now);
    if (now.sa_handler == SIG_IGN && !evenIfIgnored) return;
    action.sa_handler = onSignal;
    // What waits for input is ended by its end (endInputAtInterrupt); nothing else is to fail.
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

bool writeAll(int to, const char* bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t written = write(to, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes += written;
        count -= static_cast<std::size_t>(written);
    }
    return true;
}

/** Copies bytes until `from` ends, nobody reads `to` any more, or `woken` holds something. */
void copy(int from, int to, int woken) {
    std::array<char, 1 << 16> buffer;
    while (true) {
        std::array<pollfd, 2> waiting{{{from, POLLIN, 0}, {woken, POLLIN, 0}}};
        if (poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) break;
        if (waiting[1].revents != 0) break;
        if (waiting[0].revents == 0) continue;
        const ssize_t count = read(from, buffer.data(), buffer.size());
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count <= 0 || !writeAll(to, buffer.data(), static_cast<std::size_t>(count))) break;
    }
    close(to);
    close(from);
}
}  // namespace

void endAtInterrupt() {
    for (const int signal : {SIGINT, SIGTERM}) install(signal, false);
}

void catchInterrupts() {
    isCaught = 1;
    for (const int signal : {SIGINT, SIGTERM}) install(signal, true);
}

bool interrupted() { return isRequested != 0; }

void endInputAtInterrupt() {
    struct stat input {};
    if (fstat(STDIN_FILENO, &input) != 0 || !S_ISFIFO(input.st_mode)) return;
    std::array<int, 2> pipe{}, wake{};
    const int from = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
    if (from < 0 || pipe2(pipe.data(), O_CLOEXEC) != 0 || pipe2(wake.data(), O_CLOEXEC) != 0 ||
        dup2(pipe[0], STDIN_FILENO) < 0)
        throw Error("cannot read standard input: too many open files");
    close(pipe[0]);
    constexpr int kRoom = 1 << 20;
    fcntl(pipe[1], F_SETPIPE_SZ, kRoom);  // less is no fault
    // Signals go to the other threads; a pipe that nobody reads any more is no signal.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread(copy, from, pipe[1], wake[0]).detach();
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    wakeUp = wake[1];
}
}  // namespace delio::cli
