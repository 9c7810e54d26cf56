#include "planner/robot/slot_colour.hpp"

#include <algorithm>
#include <vector>

#include "core/index.hpp"

namespace vantage::planner {

bool may_search(const SlotHolder& own, std::span<const SlotHolder> neighbours) {
  return std::none_of(neighbours.begin(), neighbours.end(), [&](const SlotHolder& each) {
    return each.slot == own.slot && each.robot < own.robot;
  });
}

int next_slot(const SlotHolder& own, std::span<const SlotHolder> neighbours, int slots) {
  if (may_search(own, neighbours)) {
    return own.slot;
  }
  std::vector<bool> is_held(index(slots), false);
  for (const SlotHolder& each : neighbours) {
    if (each.slot >= 0 && each.slot < slots) {
      is_held[index(each.slot)] = true;
    }
  }
  std::vector<int> free;
  for (int slot = 0; slot < slots; ++slot) {
    if (!is_held[index(slot)]) {
      free.push_back(slot);
    }
  }
  return free.empty() ? own.slot : free[index(own.robot) % free.size()];
}

}  // namespace vantage::planner
