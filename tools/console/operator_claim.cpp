#include "tools/console/operator_claim.hpp"

#include <utility>

namespace vantage::tools {

bool OperatorClaim::is_held(Time now) const { return seen_ && now - *seen_ <= kPresence; }

bool OperatorClaim::is_holder(std::string_view token, Time now) const {
  return is_held(now) && is_same_secret(token, token_);
}

bool OperatorClaim::claim(std::string token, Time now) {
  if (is_held(now)) {
    return false;
  }
  token_ = std::move(token);
  seen_ = now;
  return true;
}

bool OperatorClaim::touch(std::string_view token, Time now) {
  if (!is_holder(token, now)) {
    return false;
  }
  seen_ = now;
  return true;
}

void OperatorClaim::release(std::string_view token) {
  if (is_same_secret(token, token_)) {
    seen_.reset();
  }
}

bool is_same_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(b[i]));
  }
  return difference == 0U && !a.empty();
}

}  // namespace vantage::tools
