#include "tools/observe/recorder.hpp"

#include <utility>

namespace vantage::tools {

Recorder::Recorder(std::unique_ptr<bus::Transport> endpoint, const bus::Clock& clock,
                   const std::string& path)
    : log_(path), endpoint_(std::move(endpoint)) {
  endpoint_->subscribe(
      "*", [this, &clock](std::string_view channel, std::span<const std::uint8_t> bytes) {
        log_.write(clock.now(), channel, bytes);
      });
}

}  // namespace vantage::tools
