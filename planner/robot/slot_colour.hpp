#pragma once

#include <span>

namespace vantage::planner {

/// A robot and the slot of its round in which its newest plan was made.
struct SlotHolder {
  int robot = 0;  ///< index
  int slot = 0;
};

// Shared slots are colours of a graph. Its edges join robots that are near each other
// (network.neighbourhood_m): robots that plan at the same time must not be near. The robots colour
// the graph themselves, from the slot in which each received plan was made:
//
//   A robot keeps its slot until it receives a plan made in that slot by a neighbour of lower
//   index.
// It then takes a slot that no neighbour uses. Its first plan in the new slot is its committed
// motion, which informs all neighbours of the new slot before the robot searches.
//
// If two neighbours have received each other's last plan, at most one of these neighbours searches
// in a slot. If every robot has fewer neighbours than there are slots, the colouring becomes
// permanent once the graph stops changing: the robot of lowest index among those in a slot keeps
// the slot. With fewer slots, the higher-numbered robots continue their committed motion, which is
// safe.

/// True if `own` may search in its slot. Precondition: the newest plan of `own` was made in that
/// slot.
bool may_search(const SlotHolder& own, std::span<const SlotHolder> neighbours);

/// Returns the slot of `own` in the next round. It is the same slot if may_search() or if no slot
/// is free; otherwise one that no neighbour uses, selected by robot index.
int next_slot(const SlotHolder& own, std::span<const SlotHolder> neighbours, int slots);

}  // namespace vantage::planner
