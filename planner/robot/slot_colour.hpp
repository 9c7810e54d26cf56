#pragma once

#include <span>

namespace vantage::planner {

/// A robot and the slot of its round in which its newest plan was made.
struct SlotHolder {
  int robot = 0;  ///< index
  int slot = 0;
};

// Shared slots are colours of the graph whose edges join robots that are near each other
// (network.neighbourhood_m): robots that plan at the same time must not be near. The robots colour
// the graph themselves, from the slot in which each received plan was made:
//
//   A robot keeps its slot until it receives a plan made in that slot by a neighbour of lower
//   index.
//   It then takes a slot that no neighbour holds. Its first plan there is its committed motion: a
//   claim that informs all neighbours before it searches.
//
// So of two neighbours that have received each other's last plan at most one searches in a slot. If
// every robot has fewer neighbours than there are slots, the colouring becomes permanent once the
// graph stops changing: the lowest robot that wants a slot keeps it. With fewer slots, the
// higher-numbered robots continue their committed motion, which is safe.

/// True if `own` may search in its slot. Precondition: its newest plan was made in that slot, too.
bool may_search(const SlotHolder& own, std::span<const SlotHolder> neighbours);

/// Returns own's slot of the next round: the same if may_search(), otherwise one that no neighbour
/// holds (spread over the free slots by robot index); the same if none is free.
int next_slot(const SlotHolder& own, std::span<const SlotHolder> neighbours, int slots);

}  // namespace vantage::planner
