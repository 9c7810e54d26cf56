#include "localizer/fit/robust_fit.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace vantage::localizer {
namespace {

double cauchy_loss(const std::vector<double>& residuals) {
  double loss = 0.0;
  for (const double r : residuals) {
    loss += std::log1p(r * r);
  }
  return loss;
}

}  // namespace

Eigen::VectorXd robust_fit(
    Eigen::VectorXd parameters, const Eigen::VectorXd& steps,
    const std::function<void(const Eigen::VectorXd&, std::vector<double>&)>& residuals,
    double& cost) {
  constexpr int kIterationsMax = 60;
  constexpr double kConverged = 1e-9;
  const Eigen::Index n = parameters.size();
  std::vector<double> r;
  std::vector<double> moved;
  residuals(parameters, r);
  cost = cauchy_loss(r);
  double damping = 1e-3;
  for (int iteration = 0; iteration < kIterationsMax; ++iteration) {
    Eigen::MatrixXd J(static_cast<Eigen::Index>(r.size()), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      Eigen::VectorXd at = parameters;
      at(k) += steps(k);
      residuals(at, moved);
      for (std::size_t i = 0; i < r.size(); ++i) {
        J(static_cast<Eigen::Index>(i), k) = (moved[i] - r[i]) / steps(k);
      }
    }
    Eigen::MatrixXd JtWJ = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd JtWr = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double w = 1.0 / (1.0 + r[i] * r[i]);
      const auto row = J.row(static_cast<Eigen::Index>(i));
      JtWJ += w * row.transpose() * row;
      JtWr += w * r[i] * row.transpose();
    }
    bool is_better = false;
    for (int attempt = 0; attempt < 8 && !is_better; ++attempt) {
      Eigen::MatrixXd A = JtWJ;
      A.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd tried = parameters - A.ldlt().solve(JtWr);
      residuals(tried, moved);
      const double loss = cauchy_loss(moved);
      if (loss < cost) {
        is_better = cost - loss > kConverged * cost;
        parameters = tried;
        r = moved;
        cost = loss;
        damping *= 0.3;
        break;
      }
      damping *= 4.0;
    }
    if (!is_better) {
      break;
    }
  }
  return parameters;
}

}  // namespace vantage::localizer
