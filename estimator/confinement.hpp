#pragma once

#include "models/belief/gaussian.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// A target that stays inside the world's bounds and out of its obstacles is nowhere else: the
/// moments of N(y; μ, P) · 1[y free] / Z. See reweighted() for how, and for what is returned
/// unchanged; also a belief whose ellipse touches neither wall nor obstacle.
///
/// Without it the belief about a target long unseen spreads over places where the target cannot
/// be, and its mean stays at the wall where the target was last seen. Applied step after step it
/// settles near the middle of the world, as wide as the world allows.
/// Cost: at most 343 rectangle tests an obstacle, no allocation.
models::Gaussian confine(const models::Gaussian& belief, const models::World& world);

}  // namespace vantage::estimator
