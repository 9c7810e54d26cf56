#include "models/exchange/messages.hpp"

#include <algorithm>

namespace vantage::models {

const MocapBody* MocapFrame::find(const std::string& name) const {
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const MocapBody& body) { return body.name == name; });
  return found == bodies.end() ? nullptr : &*found;
}

}  // namespace vantage::models
