// delio-live: sensors through MRPT's drivers, as a rawlog while they measure.
#include <fcntl.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/system/CRateTimer.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output.h"
#include "delio/version.h"
#include "overlap.h"
#include "waiting_objects.h"

namespace {
using namespace delio;
using mrpt::config::CConfigFile;
using mrpt::hwdrivers::CGenericSensor;

/** A driver in a thread of its own. */
class Sensor {
 public:
    /** `section`: of the settings, as for MRPT's rawlog-grabber. Throws Error where the sensor
     *  cannot be started. */
    Sensor(const CConfigFile& settings, const std::string& section, WaitingObjects& objects)
        : name_("sensor '" + section + "'"), objects_(objects) {
        const std::string driver = settings.read_string(section, "driver", "");
        try {
            if (driver.empty()) throw Error("it has no 'driver'");
            sensor_ = CGenericSensor::createSensorPtr(driver);
            if (!sensor_) throw Error("MRPT has no driver '" + driver + "'");
            sensor_->loadConfig(settings, section);
            if (!(sensor_->getProcessRate() > 0)) throw Error("its process_rate must exceed 0");
            sensor_->initialize();
        } catch (const std::exception& e) {
            throw Error(name_ + " of '" + settings.getAssociatedFile() + "': " + plainMessage(e));
        }
        thread_ = std::thread([this] { run(); });
    }
    ~Sensor() {
        isEnding_ = true;
        thread_.join();
    }
    Sensor(const Sensor&) = delete;
    Sensor& operator=(const Sensor&) = delete;

    bool hasEnded() const { return hasEnded_; }

 private:
    void run() {
        constexpr int kMostErrors_s = 2;
        mrpt::system::CRateTimer rate(sensor_->getProcessRate());
        auto latest = mrpt::Clock::now();
        try {
            while (!isEnding_) {
                sensor_->doProcess();
                objects_.add(sensor_->getObservations());
                const auto now = mrpt::Clock::now();
                if (sensor_->getState() != CGenericSensor::ssError) latest = now;
                if (now - latest > std::chrono::seconds(kMostErrors_s)) break;
                rate.sleep();
            }
            if (!isEnding_) cli::warn(name_ + " gives no more data");
        } catch (const std::exception& e) {
            cli::warn(name_ + " has failed: " + plainMessage(e));
        }
        hasEnded_ = true;
    }

    std::string name_;
    WaitingObjects& objects_;
    CGenericSensor::Ptr sensor_;
    std::atomic<bool> isEnding_{false}, hasEnded_{false};
    std::thread thread_;
};

/** What stdout was: from here on, what drivers print there goes to stderr. */
int takeStdout() {
    const int file = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    return file;
}

int open(const std::string& output, int stdoutFile) {
    const int file = output == "-"
                         ? stdoutFile
                         : ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) throw Error("cannot write '" + output + "': " + std::strerror(errno));
    return file;
}

/** False where nobody reads it any more. */
bool write(const mrpt::serialization::CSerializable& object, const std::string& output, int file) {
    std::vector<std::uint8_t> bytes;
    mrpt::serialization::ObjectToOctetVector(&object, bytes);
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t count = ::write(file, bytes.data() + done, bytes.size() - done);
        if (count >= 0)
            done += static_cast<std::size_t>(count);
        else if (errno == EPIPE)
            return false;
        else if (errno != EINTR)
            throw Error("cannot write '" + output + "': " + std::strerror(errno));
    }
    return true;
}

std::vector<std::unique_ptr<Sensor>> start(const std::string& input, WaitingObjects& objects) {
    if (!std::filesystem::is_regular_file(input))
        throw Error("cannot read '" + input + "': no such file");
    const CConfigFile settings(input);
    std::vector<std::string> sections;
    settings.getAllSections(sections);
    std::vector<std::unique_ptr<Sensor>> sensors;
    for (const auto& section : sections)
        if (section != "global" && !section.empty() &&
            !settings.read_bool(section, "rawlog-grabber-ignore", false))
            sensors.push_back(std::make_unique<Sensor>(settings, section, objects));
    if (sensors.empty()) throw Error("'" + input + "' has no section of a sensor");
    return sensors;
}

int run(const std::string& input, const std::string& output) {
    if (output == "-" && isatty(STDOUT_FILENO) == 1)
        throw Error("stdout is a terminal; pipe it to delio-slam -i -, or name a file");
    const int stdoutFile = takeStdout();
    WaitingObjects objects;
    auto sensors = start(input, objects);
    const int file = open(output, stdoutFile);
    std::signal(SIGPIPE, SIG_IGN);
    cli::catchInterrupts();
    const auto hasEnded = [](const auto& sensor) { return sensor->hasEnded(); };
    std::size_t written = 0;
    bool isRead = true, isLast = false;
    while (isRead && !isLast) {
        isLast = cli::interrupted() || std::all_of(sensors.begin(), sensors.end(), hasEnded);
        for (const auto& object : objects.take()) {
            isRead = isRead && write(*object, output, file);
            written += isRead;
        }
    }
    sensors.clear();
    close(file);
    if (objects.dropped() > 0)
        cli::warn(std::to_string(objects.dropped()) +
                  " scans were dropped because the output is read too slowly");
    if (written > 0) return cli::kExitSuccess;
    return cli::interrupted() ? cli::kExitInterrupted : cli::kExitFailedRun;
}

cli::HelpText help() {
    cli::HelpText help;
    help.about =
        "The sensors are those of a settings file of MRPT's rawlog-grabber: a section with "
        "'driver' and 'process_rate' for each. Send the rawlog to a program, "
        "\"delio-live -i INI -o - | delio-slam -i - -o OUTDIR\", or to a file. Ctrl-C ends the "
        "drive.";
    help.writes = {{"OUT", "rawlog of the observations in the order in which they came"}};
    help.examples = {{{"delio-live -i sensors.ini -o drive.rawlog", "Record a drive"},
                      {"delio-live -i velodyne.ini -o -", "Standard output, for delio-slam -i -"}}};
    help.interrupted = "the rawlog is whole up to there (0 with observations in it)";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("reads sensors through MRPT's drivers", ' ', kVersion);
    TCLAP::ValueArg<std::string> input(
        "i", "input", "Settings of the sensors, as for rawlog-grabber", true, "", "INI", cmd);
    TCLAP::ValueArg<std::string> output("o", "output", "Rawlog to write; \"-\": standard output",
                                        true, "", "OUT", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite an existing file", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "Print full error texts", cmd);
    return cli::run(cmd, help(), argc, argv, verbose, [&] {
        const std::string& out = output.getValue();
        if (out == "-") return run(input.getValue(), out);
        cli::refuseOverlap({input.getValue()}, {out});
        cli::refuseExisting(out, force.getValue());
        const io::OutputLock lock(out);
        return run(input.getValue(), out);
    });
}
