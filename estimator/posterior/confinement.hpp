#pragma once

#include "models/belief/gaussian.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// A coordinate after reflection at the walls.
struct Folded {
  double position_m = 0.0;
  double sign = 1.0;  ///< −1 if the direction of the axis is reversed, otherwise 1
};
/// Reflects a coordinate at both walls, as often as needed.
Folded fold(double position_m, double min_m, double max_m);

/// Returns the free space of a disc's centre: walls and obstacles grow by the radius, with sharp
/// corners. Bounds that would become empty are not changed.
models::World inset(const models::World& world, double radius_m);

/// Conditions a belief on the target staying within the world's bounds and outside of obstacles. A
/// belief that reaches neither the bounds nor an obstacle is returned unchanged, bit for bit.
///
/// Beliefs with a velocity (4 components) are reflected at the bounds, see reflect(); they are then
/// conditioned on the obstacles alone. Beliefs without a velocity are conditioned on both.
/// Conditioning computes the moments of N(y; μ, P) · 1[y free] / Z. See reweighted() for the method
/// and for the cases that it leaves unchanged.
///
/// Without confinement, the belief of a target that is unseen for a long time spreads over
/// impossible positions. Its mean stays where the target was last seen. With confinement, the mean
/// approaches the middle of the world, and the covariance the size of the world.
/// Cost: at most 343 rectangle tests per obstacle, no allocation.
models::Gaussian confine(const models::Gaussian& belief, const models::World& world);

/// Returns the Gaussian with the mean and covariance of the belief after reflection at `bounds`. A
/// position beyond a wall is mirrored to the inside and its velocity across the wall is reversed,
/// as often as needed. A confident belief that crosses a wall thus loses the direction of the
/// target until the next detection. If the belief were instead conditioned on the inside, it would
/// state with too much confidence that the target stopped at the wall.
///
/// The moments come from the product rule of moment_matching.hpp on the position, with the exact
/// Gaussian of the velocity at each of its points. The belief is returned unchanged when its
/// covariance is not positive definite, no point of the rule lies outside, or the bounds have no
/// area.
/// Precondition: 4 components.
/// Cost: 225 points, no allocation.
models::Gaussian reflect(const models::Gaussian& belief, const models::Rectangle& bounds);

}  // namespace vantage::estimator
