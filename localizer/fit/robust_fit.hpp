#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace vantage::localizer {

/// Minimises Σ log(1 + r²), the Cauchy loss of the residuals r that `residuals` writes, by
/// Levenberg–Marquardt with numerical derivatives (robust nonlinear least squares).
/// @param steps  per parameter: step of the numerical derivative
/// @return the parameters; `cost` receives their loss
Eigen::VectorXd robust_fit(
    Eigen::VectorXd parameters, const Eigen::VectorXd& steps,
    const std::function<void(const Eigen::VectorXd&, std::vector<double>&)>& residuals,
    double& cost);

/// Fits the line y = scale · x + offset by reweighted least squares, with the Cauchy loss of the
/// errors in units of `sigma`. Returns the loss. Without `has_offset`, the offset is 0.
double robust_line(const std::vector<double>& x, const std::vector<double>& y, double sigma,
                   bool has_offset, double& scale, double& offset);

/// Delay and lag of a response to commands, s.
struct Response {
  double delay_s = 0.0;
  double lag_s = 0.0;
};

/// Returns the response with the least `loss`(delay, lag): a search over delays up to 0.4 s and
/// lags up to 0.3 s.
Response least_loss_response(const std::function<double(double, double)>& loss);

}  // namespace vantage::localizer
