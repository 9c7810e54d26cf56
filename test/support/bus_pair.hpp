#pragma once

#include <cstdint>
#include <memory>

#include "bus/node/bus.hpp"
#include "bus/transport/transport.hpp"

namespace vantage::test {

/// Two buses on one network, as in two processes of a trial.
struct BusPair {
  BusPair(std::int64_t own_run, std::int64_t other_run)
      : own(*own_link, own_run), other(*other_link, other_run) {}

  bus::InProcessHub hub;
  std::unique_ptr<bus::Transport> own_link = hub.connect();
  std::unique_ptr<bus::Transport> other_link = hub.connect();
  bus::Bus own;
  bus::Bus other;
};

}  // namespace vantage::test
