#include "cli.h"

#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/core/Clock.h>
#include <mrpt/core/aligned_allocator.h>
#include <mrpt/system/datetime.h>
#include <mrpt/system/progress.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <utility>
#include <vector>

#include "command_line_output.h"
#include "delio/core/error.h"
#include "delio/core/text.h"

/** Replaces MRPT's function: containers of MRPT 2.5.8 do not check whether an allocation succeeded.
 *  A program's own functions take precedence over those of its libraries. */
void* mrpt::aligned_malloc(std::size_t size, std::size_t alignment) {
    void* memory = nullptr;
    if (posix_memalign(&memory, alignment, size) != 0) throw std::bad_alloc();
    return memory;
}

namespace delio::cli {
namespace {
void say(const std::string& text) {
    constexpr std::size_t kMost = 2000;  // names and values come from files of others
    std::cerr << program_invocation_short_name << ": " << printable(shortened(text, kMost))
              << std::endl;
}

/** Lets nothing through to stdout that a terminal takes for a command: names and labels come from
 *  files of others. */
class PlainOutput : public std::streambuf {
 public:
    PlainOutput() : to_(std::cout.rdbuf(this)) {}
    ~PlainOutput() override { std::cout.rdbuf(to_); }
    PlainOutput(const PlainOutput&) = delete;
    PlainOutput& operator=(const PlainOutput&) = delete;

 protected:
    int_type overflow(int_type c) override {
        const bool isControl = (c < ' ' && c != '\n' && c != '\t') || c == '\x7F';
        const bool isSecond = std::exchange(last_, c) == 0xC2 && c < 0xA0;  // of C2 80 to C2 9F
        return c == traits_type::eof()
                   ? 0
                   : to_->sputc(isControl || isSecond ? '?' : traits_type::to_char_type(c));
    }
    int sync() override { return to_->pubsync(); }

 private:
    std::streambuf* to_;
    int_type last_ = 0;
};
}  // namespace

std::istream& operator>>(std::istream& in, Count& count) {
    if ((in >> std::ws).peek() == '-')
        in.setstate(std::ios::failbit);
    else
        in >> count.value;
    return in;
}

namespace {
/** The argument that `word` is the name of, or null. */
TCLAP::Arg* argumentOf(TCLAP::CmdLine& cmd, const std::string& word) {
    const auto& args = cmd.getArgList();
    const auto found = std::find_if(args.begin(), args.end(),
                                    [&](const TCLAP::Arg* arg) { return arg->argMatches(word); });
    return found == args.end() ? nullptr : *found;
}

/** GNU's --name=VALUE as TCLAP takes it: two words. */
std::vector<std::string> wordsOf(TCLAP::CmdLine& cmd, int argc, const char* const* argv) {
    const auto takesValue = [&](const std::string& word) {
        const auto* arg = argumentOf(cmd, word);
        return arg && arg->isValueRequired();
    };
    std::vector<std::string> words;
    bool isValue = false;
    for (const std::string& word : std::vector<std::string>(argv, argv + argc)) {
        const auto equals = word.find('=');
        const std::string name = word.substr(0, equals);
        const bool isBoth =
            !isValue && equals != word.npos && name.rfind("--", 0) == 0 && takesValue(name);
        words.push_back(isBoth ? name : word);
        if (isBoth) words.push_back(word.substr(equals + 1));
        isValue = !isValue && !isBoth && takesValue(word);
    }
    return words;
}

/** Only the last of an argument that is given again, unless it may be repeated: TCLAP would refuse
 *  it. */
std::vector<std::string> lastOfEach(TCLAP::CmdLine& cmd, const std::vector<std::string>& words) {
    struct Given {
        const TCLAP::Arg* arg;
        std::vector<std::string> words;
    };
    std::vector<Given> all;
    for (std::size_t i = 0; i < words.size(); ++i) {
        auto* const arg = argumentOf(cmd, words[i]);
        if (arg && !arg->acceptsMultipleValues())
            all.erase(std::remove_if(all.begin(), all.end(),
                                     [&](const Given& other) { return other.arg == arg; }),
                      all.end());
        all.push_back({arg, {words[i]}});
        if (arg && arg->isValueRequired() && i + 1 < words.size())
            all.back().words.push_back(words[++i]);
    }
    std::vector<std::string> kept;
    for (const auto& given : all) kept.insert(kept.end(), given.words.begin(), given.words.end());
    return kept;
}

/** Handler of std::terminate, for exceptions that no one can catch, such as in a thread of TBB that
 * is out of memory. Allocates nothing. */
[[noreturn]] void endInOneLine() noexcept {
    const auto end = [](const char* why) {
        std::fprintf(stderr, "%s: %.*s\n", program_invocation_short_name,
                     static_cast<int>(std::strcspn(why, "\n")), why);
        std::_Exit(kExitFailedRun);
    };
    try {
        if (const auto fault = std::current_exception()) std::rethrow_exception(fault);
    } catch (const std::bad_alloc&) {
        end("out of memory");
    } catch (const std::exception& e) {
        end(plainMessage(e).c_str());
    } catch (...) {
    }
    end("stopped by an internal error");
    std::abort();
}
}  // namespace

std::vector<double> numbersIn(std::string text, std::size_t count) {
    std::vector<double> numbers;
    text += ',';
    for (std::size_t from = 0, to; (to = text.find(',', from)) != text.npos; from = to + 1) {
        const auto number = numberIn<double>(std::string_view(text).substr(from, to - from));
        if (!number || !std::isfinite(*number)) return {};
        numbers.push_back(*number);
    }
    if (numbers.size() != count) return {};
    return numbers;
}

int run(TCLAP::CmdLine& cmd, const HelpText& help, int argc, const char* const* argv,
        TCLAP::SwitchArg& verbose, const std::function<int()>& body) {
    std::set_terminate(endInOneLine);
    endAtInterrupt();
    const PlainOutput plain;
    CommandLineOutput output(cmd, help);
    cmd.setOutput(&output);
    const auto words = lastOfEach(cmd, wordsOf(cmd, argc, argv));
    std::vector<const char*> plainWords;
    plainWords.reserve(words.size());
    for (const auto& word : words) plainWords.push_back(word.c_str());
    if (!cmd.parse(static_cast<int>(plainWords.size()), plainWords.data()))
        return output.hasFailed() ? kExitBadCommandLine : kExitSuccess;
    try {
        return body();
    } catch (const Error& e) {
        say(e.what());
    } catch (const std::exception& e) {
        say(verbose.getValue() ? e.what() : plainMessage(e));
    }
    return kExitFailedRun;
}

void warn(const std::string& text) { say("warning: " + text); }

void inform(const std::string& text) { say(text); }

void refuseExisting(const std::string& path, bool force) {
    if (!force && std::filesystem::exists(path))
        throw Error("'" + path + "' exists; choose another name or overwrite it with --force");
}

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      begin_s_(mrpt::Clock::nowDouble()) {}

Progress::~Progress() {
    if (terminal_ && lastShown_s_ >= 0) std::cerr << std::endl;
}

void Progress::update(std::size_t done, std::optional<double> fraction) {
    if (total_ > 0) fraction = static_cast<double>(done) / static_cast<double>(total_);
    const std::string count =
        std::to_string(done) + (total_ > 0 ? "/" + std::to_string(total_) : "");
    if (!terminal_) {
        if (!fraction || *fraction < nextLine_) return;
        while (nextLine_ <= *fraction) nextLine_ += 0.1;
        inform(what_ + " " + count);
        return;
    }
    const double now = mrpt::Clock::nowDouble();
    if (now - lastShown_s_ < 0.1 && done != total_) return;
    lastShown_s_ = now;
    std::cerr << "\r" << what_ << " " << count;
    if (fraction && *fraction > 0)
        std::cerr << " " << mrpt::system::progress(*fraction, 30) << " ETA "
                  << mrpt::system::formatTimeInterval((now - begin_s_) * (1 / *fraction - 1));
    std::cerr << "   " << std::flush;
}
}  // namespace delio::cli
