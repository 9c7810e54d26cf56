#pragma once

#include <functional>

namespace vantage::tools {

/// What the chosen subcommand does; its exit code.
using Runner = std::function<int()>;

}  // namespace vantage::tools
