#include "live_output.h"

#include <chrono>
#include <thread>

#include "cli.h"

namespace delio {
LiveOutput::LiveOutput(SlamCommandLine& line) {
    if (!line.gui.getValue() && !line.serve.isSet()) return;
    map_ = std::make_shared<LiveMap>();
    if (line.serve.isSet()) {
        const auto& inputs = line.input.getValue();
        const std::string first = inputs.front() == "-" ? "standard input" : inputs.front();
        server_ =
            std::make_unique<MapServer>(static_cast<std::uint16_t>(line.serve.getValue()), map_,
                                        first + (inputs.size() > 1 ? " and others" : ""));
        cli::inform("the map is at " + server_->address());
    }
    if (line.gui.getValue()) view_ = std::make_unique<LiveView>(map_);
}

void LiveOutput::begin(run::Run& run) {
    if (!map_) return;
    map_->clear();
    run.attach(map_);
}

void LiveOutput::end() {
    if (map_) map_->end();
}

void LiveOutput::waitForWindow() const {
    if (!view_ || !view_->isOpen()) return;
    cli::inform("done; close the window to end");
    while (view_->isOpen() && !cli::interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
}
}  // namespace delio
