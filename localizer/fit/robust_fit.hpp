#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace vantage::localizer {

/// Robust nonlinear least squares: minimises Σ log(1 + r²), the Cauchy loss of the residuals that
/// `residuals` writes, by Levenberg–Marquardt with numerical derivatives.
/// @param steps  per parameter: step of the numerical derivative
/// @return the parameters; `cost` receives their loss
Eigen::VectorXd robust_fit(
    Eigen::VectorXd parameters, const Eigen::VectorXd& steps,
    const std::function<void(const Eigen::VectorXd&, std::vector<double>&)>& residuals,
    double& cost);

}  // namespace vantage::localizer
