#pragma once

#include "models/belief/gaussian.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// A coordinate that turned back at each wall it met.
struct Folded {
  double position_m = 0.0;
  double sign = 1.0;  ///< −1: it now runs the other way
};
/// Where a coordinate comes to that turns back at both walls, as often as needed.
Folded fold(double position_m, double min_m, double max_m);

/// `world` as the middle of a disc has it: walls and obstacles nearer by its radius, with sharp
/// corners. Bounds of which nothing would be left stay.
models::World inset(const models::World& world, double radius_m);

/// What is known of a target's place because it never leaves the world's bounds nor enters an
/// obstacle. A belief that touches neither is returned unchanged, bit for bit.
///
/// Beliefs with a velocity (4 components) are reflected at the bounds, see reflect(): what they say
/// lies outside has turned back at the wall; of the free world only the obstacles are then left to
/// condition on. Beliefs without a velocity are conditioned on all of it. Conditioning is the
/// moments of N(y; μ, P) · 1[y free] / Z; see reweighted() for how, and for what it leaves alone.
///
/// Without it the belief about a target long unseen spreads over places where the target cannot
/// be, and its mean stays at the wall where the target was last seen. Applied step after step it
/// settles near the middle of the world, as wide as the world allows.
/// Cost: at most 343 rectangle tests an obstacle, no allocation.
models::Gaussian confine(const models::Gaussian& belief, const models::World& world);

/// The Gaussian of the same mean and covariance as the belief about position and velocity (4
/// components) folded into `bounds`: who is predicted beyond a wall is as far inside of it, the
/// velocity across it reversed, as often as needed. A confident belief that crosses a wall thus
/// forgets which way the target goes, until it is seen again; conditioning on the inside instead
/// would conclude that the target stopped at the wall, and be sure of it.
///
/// The moments come from the product rule of moment_matching.hpp on the position, with the exact
/// Gaussian of the velocity at each of its points. Unchanged: a covariance that is not positive
/// definite, a belief no point of whose rule lies outside, bounds without area.
/// Precondition: 4 components. Cost: 225 points, no allocation.
models::Gaussian reflect(const models::Gaussian& belief, const models::Rectangle& bounds);

}  // namespace vantage::estimator
