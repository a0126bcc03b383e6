#include "command_line_output.h"

#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <cctype>
#include <iostream>
#include <sstream>
#include <vector>

#include "cli.h"
#include "delio/core/text.h"

namespace delio::cli {
namespace {
using TCLAP::ValueArg;

constexpr std::size_t kWidth = 80, kColumn = 26;

/** `text` in lines from `column` on, beside `head` or, where that is too long, below it. */
std::string filled(const std::string& head, const std::string& text, std::size_t column) {
    std::string done, line = head;
    if (column > 0 && line.size() + 2 > column) {
        done = line + "\n";
        line.clear();
    }
    line.resize(column, ' ');
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (line.size() > column && line.size() + 1 + word.size() > kWidth) {
            done += line + "\n";
            line.assign(column, ' ');
        }
        line += (line.size() > column ? " " : "") + word;
    }
    return done + line + "\n";
}

std::string listed(const std::string& title, const std::vector<HelpText::Row>& rows,
                   std::size_t column) {
    if (rows.empty()) return "";
    std::string list = "\n" + title + ":\n";
    for (const auto& row : rows) list += filled("  " + row.name, row.meaning, column);
    return list;
}

/** Splits a TCLAP value name such as "DEG, 0 to 90" into name and range. */
struct ValueName {
    explicit ValueName(const TCLAP::Arg& arg) {
        const std::string id = arg.longID();
        const auto begin = id.find('<') + 1, end = id.find('>');
        name = id.substr(begin, end - begin);
        const auto comma = name.find(", ");
        if (comma == name.npos) return;
        range = name.substr(comma + 2);
        name.erase(comma);
    }
    std::string name, range;
};

/** Default value of an argument; may be empty. */
std::string valueOf(TCLAP::Arg& arg) {
    if (auto* text = dynamic_cast<ValueArg<std::string>*>(&arg)) return text->getValue();
    if (auto* count = dynamic_cast<ValueArg<Count>*>(&arg))
        return digitsOf(count->getValue().value);
    if (auto* whole = dynamic_cast<ValueArg<int>*>(&arg)) return digitsOf(whole->getValue());
    if (auto* number = dynamic_cast<ValueArg<double>*>(&arg)) return digitsOf(number->getValue());
    return "";
}

/** In the order in which they were added, those that are required first. */
std::vector<TCLAP::Arg*> argumentsOf(TCLAP::CmdLineInterface& cmd) {
    const auto& list = cmd.getArgList();
    std::vector<TCLAP::Arg*> arguments(list.rbegin(), list.rend());
    const auto isOwn = [](const TCLAP::Arg* arg) {
        const auto& name = arg->getName();
        return name != "help" && name != "version" && name != TCLAP::Arg::ignoreNameString();
    };
    arguments.erase(std::find_if(arguments.begin(), arguments.end(), [](const TCLAP::Arg* arg) {
        return arg->getName() == TCLAP::Arg::ignoreNameString();
    }));
    const auto own = std::stable_partition(arguments.begin(), arguments.end(), isOwn);
    std::stable_partition(arguments.begin(), own,
                          [](const TCLAP::Arg* arg) { return arg->isRequired(); });
    return arguments;
}

std::string usageOf(const std::vector<TCLAP::Arg*>& arguments) {
    std::string usage = std::string("Usage: ") + program_invocation_short_name;
    for (auto* arg : arguments) {
        if (!arg->isRequired()) continue;
        std::string value = ValueName(*arg).name;
        if (value.find('|') != value.npos) {  // one of several: in one line they have no room
            value = arg->getName();
            for (auto& letter : value) letter = static_cast<char>(std::toupper(letter));
        }
        usage +=
            arg->getFlag().empty() ? " --" + arg->getName() + "=" : " -" + arg->getFlag() + " ";
        usage += value + (arg->acceptsMultipleValues() ? "..." : "");
    }
    return usage + " [OPTION]...\n";
}

std::string lineOf(TCLAP::Arg& arg) {
    std::string head = arg.getFlag().empty() ? "      --" : "  -" + arg.getFlag() + ", --";
    head += arg.getName();
    std::string text = arg.getDescription();
    if (arg.isValueRequired()) {
        const ValueName value(arg);
        head += "=" + value.name;
        if (!value.range.empty()) text += "; " + value.range;
    }
    if (arg.acceptsMultipleValues()) text += "; may be repeated";
    // What no value can say, the description does.
    const std::string value = valueOf(arg);
    if (!arg.isRequired() && !value.empty() && text.find("default") == text.npos)
        text += "; default: " + value;
    return filled(head, text, kColumn);
}

/** Message for an argument without option; empty if `e` is another fault. */
std::string unexpectedIn(TCLAP::CmdLineInterface& cmd, const TCLAP::ArgException& e) {
    const std::string begin = "Argument: ", argument = e.argId();
    if (e.error().find("match for argument") == std::string::npos || argument.find(begin) != 0)
        return "";
    const std::string word = argument.substr(begin.size());
    const auto has = [&](const char* flag) {
        const auto& all = cmd.getArgList();
        return std::any_of(all.begin(), all.end(),
                           [&](const TCLAP::Arg* arg) { return arg->getFlag() == flag; });
    };
    if (!word.empty() && word.front() == '-') return "unknown option '" + word + "'; see --help";
    return "unexpected argument '" + word + "'; " +
           (has("i") && has("o") ? "give inputs with -i and outputs with -o (see --help)"
                                 : "give every argument with an option (see --help)");
}

std::string helpOf(TCLAP::CmdLineInterface& cmd, const HelpText& text) {
    const auto arguments = argumentsOf(cmd);
    std::string help = program_invocation_short_name + (": " + cmd.getMessage()) + "\n\n";
    help += usageOf(arguments);
    if (!text.about.empty()) help += "\n" + filled("", text.about, 0);
    help += "\nOptions:\n";
    for (auto* arg : arguments) help += lineOf(*arg);
    help += listed("Sections of --set", text.sections, kColumn);
    help += listed("Writes", text.writes, kColumn);
    help += "\nExamples:\n";
    for (const auto& [command, purpose] : text.examples)
        help += "  " + purpose + ":\n      $ " + command + "\n";
    constexpr std::size_t kCodes = 7;
    return help +
           listed("Exit status",
                  {{std::to_string(kExitSuccess), "success"},
                   {std::to_string(kExitFailedRun), "the run failed; stderr says why, in one line"},
                   {std::to_string(kExitBadCommandLine), "wrong command line"},
                   {std::to_string(kExitInterrupted), "interrupted: " + text.interrupted}},
                  kCodes);
}
}  // namespace

CommandLineOutput::CommandLineOutput(TCLAP::CmdLineInterface& cmd, const HelpText& text)
    : help_(helpOf(cmd, text)) {}

void CommandLineOutput::usage(TCLAP::CmdLineInterface&) { std::cout << help_ << std::flush; }

void CommandLineOutput::version(TCLAP::CmdLineInterface& cmd) {
    std::cout << program_invocation_short_name << " " << cmd.getVersion() << std::endl;
}

void CommandLineOutput::failure(TCLAP::CmdLineInterface& cmd, TCLAP::ArgException& e) {
    failed_ = true;
    if (const std::string text = unexpectedIn(cmd, e); !text.empty()) return inform(text);
    std::string which = e.argId();
    if (which.find_first_not_of(' ') == std::string::npos) {  // something required is missing
        which.clear();
        for (TCLAP::Arg* arg : cmd.getArgList())
            if (arg->isRequired() && !arg->isSet())
                which += (which.empty() ? "--" : ", --") + arg->getName();
    }
    inform(e.error() + (which.empty() ? "" : " (" + which + ")") + "; see --help");
}
}  // namespace delio::cli
