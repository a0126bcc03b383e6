#include "virtual_display.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "command.h"

namespace delio::test {
namespace {
/** The server keeps its picture as X Window Dump does: a header of big-endian words, colours, rows
 *  of 32 bits a pixel, blue first. */
mrpt::img::CImage readXwd(const std::string& bytes) {
    const auto word = [&](std::size_t i) {
        std::uint32_t value = 0;
        for (std::size_t k = 0; k < 4; ++k)
            value = value << 8 | static_cast<unsigned char>(bytes.at(4 * i + k));
        return std::size_t{value};
    };
    constexpr std::size_t kColour = 12;
    const std::size_t width = word(4), height = word(5), rowBytes = word(12);
    const std::size_t begin = word(0) + word(19) * kColour;
    mrpt::img::CImage image(static_cast<unsigned>(width), static_cast<unsigned>(height),
                            mrpt::img::CH_RGB);
    for (std::size_t row = 0; row < height; ++row)
        for (std::size_t column = 0; column < width; ++column) {
            const char* p = &bytes.at(begin + row * rowBytes + 4 * column);
            const auto channel = [&](int i) { return static_cast<std::uint8_t>(p[i]); };
            image.setPixel(static_cast<int>(column), static_cast<int>(row),
                           mrpt::img::TColor(channel(2), channel(1), channel(0)));
        }
    return image;
}
}  // namespace

bool isInstalled(const std::string& program) {
    return runTool("sh", {"-c", "command -v " + program}).exitCode == 0;
}

pid_t VirtualDisplay::run(const std::vector<std::string>& words, int output) const {
    std::vector<std::string> copies = words;
    std::vector<char*> argv;
    for (auto& text : copies) argv.push_back(text.data());
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child != 0) return child;
    const int nothing = open("/dev/null", O_RDWR);
    dup2(nothing, STDIN_FILENO);
    dup2(output >= 0 ? output : nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    setenv("HOME", folder_.path().c_str(), 1);
    execvp(argv[0], argv.data());
    _exit(127);
}

VirtualDisplay::VirtualDisplay() {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    processes_.push_back(run({"Xvfb", "-displayfd", "1", "-screen", "0", "1280x900x24", "-fbdir",
                              folder_.path().string()},
                             ends[1]));
    close(ends[1]);
    std::string number;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
    close(ends[0]);
    setenv("DISPLAY", (":" + number).c_str(), 1);
}

VirtualDisplay::~VirtualDisplay() {
    for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
        kill(*process, SIGTERM);
        waitpid(*process, nullptr, 0);
    }
    unsetenv("DISPLAY");
}

void VirtualDisplay::start(const std::string& program, const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {toolPath(program)};
    words.insert(words.end(), arguments.begin(), arguments.end());
    processes_.push_back(run(words, -1));
}

std::vector<std::string> VirtualDisplay::windows() const {
    std::vector<std::string> titles;
    std::istringstream lines(runTool("xwininfo", {"-root", "-tree"}).out);
    for (std::string line; std::getline(lines, line);) {
        const auto begin = line.find('"'), end = line.find("\": (");
        // wxWidgets keeps small windows of its own, 10x10 and 200x200, that nobody sees.
        const bool seen = line.find(" 10x10+") == line.npos && line.find(" 200x200+") == line.npos;
        if (begin != line.npos && end != line.npos && seen)
            titles.push_back(line.substr(begin + 1, end - begin - 1));
    }
    return titles;
}

bool VirtualDisplay::waitFor(const std::string& text) const {
    for (int i = 0; i < 300; ++i) {
        for (const auto& title : windows())
            if (title.find(text) != std::string::npos) return true;
        usleep(200000);
    }
    return false;
}

mrpt::img::CImage VirtualDisplay::screenshot() const {
    return readXwd(readText(folder_ / "Xvfb_screen0"));
}
}  // namespace delio::test
