#include "scenario/search_name.hpp"

#include <algorithm>
#include <utility>

#include "core/check.hpp"

namespace vantage::scenario {
namespace {

std::vector<std::string>& names() {
  static std::vector<std::string> all(kSearchNames.begin(), kSearchNames.end());
  return all;
}

}  // namespace

const std::vector<std::string>& search_names() { return names(); }

void add_search_name(std::string name) {
  require(!name.empty() && name != kExternalSearch && std::ranges::count(names(), name) == 0,
          "search: the name '" + name + "' is empty or already in use");
  names().push_back(std::move(name));
}

}  // namespace vantage::scenario
