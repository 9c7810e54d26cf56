#pragma once

#include <span>

namespace vantage::planner {

/// Which robot's newest plan was made in which slot of its round.
struct SlotHolder {
  int robot = 0;  ///< by index
  int slot = 0;
};

// Slots that robots share are colours of the graph in which two robots are joined when they are
// near each other (network.neighbourhood_m): who plans at the same time must not be near. The
// robots colour it themselves, by what their plans say anyhow, the slot that each was made in:
//
//   a robot keeps its slot until a neighbour of lower index is heard in it; then it takes one that
//   no neighbour holds, and what it publishes there first is what it is committed to: a claim, by
//   which all neighbours know of it before it plans.
//
// So of two neighbours who have heard each other's last plan never more than one searches in a
// slot, whatever slots they take; and a graph in which nobody has more neighbours than there are
// slots, less one, is coloured for good as soon as it stays the same, for the lowest of those who
// want a slot keeps it. Where there are fewer slots, the higher robots go on with what they are
// committed to, which is safe.

/// Whether `own` may search in its slot. Precondition: its newest plan was made in it, too.
bool may_search(const SlotHolder& own, std::span<const SlotHolder> neighbours);

/// The slot of own's next round: the same while may_search(), else one that no neighbour holds (a
/// different one for each robot that looks, as far as they go); the same if there is none.
int next_slot(const SlotHolder& own, std::span<const SlotHolder> neighbours, int slots);

}  // namespace vantage::planner
