#include "tools/up/landing.hpp"

namespace vantage::tools {

Landing::Step Landing::step(bool is_at_rest, bool is_urgent, Time now) {
  if (is_at_rest) {
    return Step::kOver;
  }
  if (!is_hurried_ && (is_urgent || now >= give_up_)) {
    is_hurried_ = true;
    give_up_ = now + kHurriedPatience;
    return Step::kRequestAgain;
  }
  return now >= give_up_ ? Step::kOver : Step::kWait;
}

}  // namespace vantage::tools
