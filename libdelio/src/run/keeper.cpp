#include "delio/run/keeper.h"

#include <algorithm>
#include <fstream>
#include <ostream>

#include "core/checkpoint.h"
#include "delio/core/error.h"
#include "delio/files/output_file.h"
#include "delio/run/run_folder.h"
#include "row_files.h"

namespace delio::run {
namespace fs = std::filesystem;

namespace {
constexpr std::chrono::seconds kInterval{1};

/** By value: what was written is dropped at once. */
void replaceState(const std::string& path, std::string state) {
    io::replaceFile(path, [&](const std::string& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out.write(state.data(), static_cast<std::streamsize>(state.size()));
        out.close();
        if (out) io::putOnDisk(temporary);
        return static_cast<bool>(out);
    });
}
}  // namespace

Keeper::Keeper(const std::string& results, std::string drive)
    : folder_(fs::path(results) / kFolder), state_(folder_ / "state"), drive_(std::move(drive)) {}

Keeper::~Keeper() {
    try {
        if (writing_.valid()) writing_.wait();
        if (begun_ && !hasState()) remove();
    } catch (const std::exception&) {
        // Even to remove a folder takes memory: it stays, and hasState() says that it holds
        // nothing.
    }
}

bool Keeper::hasState() const { return fs::exists(state_); }

void Keeper::begin() {
    begun_ = true;
    std::error_code fault;
    fs::remove_all(folder_, fault);
    if (!fault) fs::create_directories(folder_, fault);
    if (fault) throw Error("cannot make the folder '" + folder() + "': " + fault.message());
}

void Keeper::resume(Run& run) const {
    std::ifstream in(state_, std::ios::binary);
    if (!in) throw Error("cannot read '" + state_.string() + "'");
    try {
        checkpoint::readPart(in, {"drive", drive_});
        run.restore(in);
    } catch (const Error& e) {
        throw Error("the run in '" + folder() + "' cannot be gone on with: " + e.what() +
                    " (--force begins anew)");
    }
}

void Keeper::addRows(const Run& run) {
    if (!files_) files_ = std::make_unique<RowFiles>(folder_);
    const auto& rows = run.record().rows;
    for (; rows_ < rows.size(); ++rows_) files_->add(rows[rows_], run.odometry().poses[rows_]);
    const auto now = Clock::now();
    if (now < flushAt_) return;
    files_->flush();
    flushAt_ = now + kInterval;
}

void Keeper::writeState(const Run& run) {
    if (writing_.valid()) writing_.get();
    const auto begin = Clock::now();
    checkpoint::Bytes bytes;
    std::ostream state(&bytes);
    checkpoint::writePart(state, {"drive", drive_}, "");
    run.save(state);
    constexpr int kShare = 20;
    keepAt_ = begin + std::max<Clock::duration>(kInterval, kShare * (Clock::now() - begin));
    writing_ = std::async(std::launch::async, replaceState, state_.string(), bytes.take());
}

template <typename Work>
void Keeper::unlessGivenUp(const Work& work) {
    if (givenUp_) return;
    try {
        work();
    } catch (...) {
        givenUp_ = true;
        files_.reset();
        for (const char* name : {"state", RunFolder::kScans, RunFolder::kOdometry}) {
            std::error_code ignored;
            fs::remove(folder_ / name, ignored);
        }
        throw;
    }
}

void Keeper::add(const Run& run) {
    unlessGivenUp([&] {
        addRows(run);
        const bool isFree = !writing_.valid() ||
                            writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
        if (Clock::now() >= keepAt_ && isFree) writeState(run);
    });
}

void Keeper::keep(const Run& run) {
    unlessGivenUp([&] {
        files_->flush();
        writeState(run);
        writing_.get();
    });
}

void Keeper::remove() {
    if (writing_.valid()) writing_.wait();
    files_.reset();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}
}  // namespace delio::run
