#include "core/check.hpp"

namespace vantage {

void require(bool holds, const std::string& rule) {
  if (!holds) {
    throw UsageError(rule);
  }
}

}  // namespace vantage
