#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "packet_decoder.h"

namespace delio::io {
/** A decoder that leaves the work to another one, which the first packet chooses. */
class ForwardingDecoder : public PacketDecoder {
 public:
    void finish() override {
        if (decoder_) decoder_->finish();
    }
    std::optional<Scan> take() override { return decoder_ ? decoder_->take() : std::nullopt; }
    std::string sensor() const override { return decoder_ ? decoder_->sensor() : ""; }
    std::vector<std::string> findings() const override {
        return decoder_ ? decoder_->findings() : std::vector<std::string>{};
    }

 protected:
    std::unique_ptr<PacketDecoder> decoder_;  //!< null before the first packet
};
}  // namespace delio::io
