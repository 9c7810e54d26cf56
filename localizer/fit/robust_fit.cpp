#include "localizer/fit/robust_fit.hpp"

#include <cmath>
#include <limits>

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

double robust_line(const std::vector<double>& x, const std::vector<double>& y, double sigma,
                   bool has_offset, double& scale, double& offset) {
  constexpr int kPasses = 6;
  scale = 1.0;
  offset = 0.0;
  double loss = 0.0;
  for (int pass = 0; pass <= kPasses; ++pass) {
    double n = 0.0;
    double sx = 0.0;
    double sy = 0.0;
    double sxx = 0.0;
    double sxy = 0.0;
    loss = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double r = (y[i] - scale * x[i] - offset) / sigma;
      loss += std::log1p(r * r);
      const double w = 1.0 / (1.0 + r * r);
      n += w;
      sx += w * x[i];
      sy += w * y[i];
      sxx += w * x[i] * x[i];
      sxy += w * x[i] * y[i];
    }
    if (pass == kPasses) {
      break;
    }
    const double spread = has_offset ? n * sxx - sx * sx : sxx;
    if (spread <= 0.0) {
      break;
    }
    scale = has_offset ? (n * sxy - sx * sy) / spread : sxy / sxx;
    offset = has_offset ? (sy - scale * sx) / n : 0.0;
  }
  return loss;
}

Response least_loss_response(const std::function<double(double, double)>& loss) {
  // Searches coarsely over a grid, then with halved steps around the best point.
  Response found;
  double best = std::numeric_limits<double>::infinity();
  const auto try_at = [&](double delay, double lag) {
    if (delay < 0.0 || lag < 0.0) {
      return;
    }
    if (const double tried = loss(delay, lag); tried < best) {
      best = tried;
      found = {delay, lag};
    }
  };
  for (int i = 0; i <= 8; ++i) {
    for (int k = 0; k <= 6; ++k) {
      try_at(0.05 * i, 0.05 * k);
    }
  }
  for (const double step_s : {0.025, 0.0125, 0.00625}) {
    const double delay = found.delay_s;
    const double lag = found.lag_s;
    for (const double of_delay : {-step_s, 0.0, step_s}) {
      for (const double of_lag : {-step_s, 0.0, step_s}) {
        try_at(delay + of_delay, lag + of_lag);
      }
    }
  }
  return found;
}

}  // namespace vantage::localizer
