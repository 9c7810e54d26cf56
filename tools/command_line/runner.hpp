#pragma once

#include <functional>

namespace vantage::tools {

/// Action of the chosen subcommand; returns the exit code.
using Runner = std::function<int()>;

}  // namespace vantage::tools
