#include "models/target/target_model.hpp"

namespace vantage::models {

int TargetModel::dim() const { return kind == TargetKind::kDoubleIntegrator ? 4 : position_dim; }

StateMatrix TargetModel::transition(double dt_s) const {
  StateMatrix A = StateMatrix::Identity(dim(), dim());
  if (kind == TargetKind::kDoubleIntegrator) {
    A(0, 2) = dt_s;
    A(1, 3) = dt_s;
  }
  return A;
}

StateMatrix TargetModel::process_noise(double dt_s, int steps_unseen) const {
  StateMatrix W = StateMatrix::Zero(dim(), dim());
  switch (kind) {
    case TargetKind::kStatic:
      break;
    case TargetKind::kRandomWalk:
      W.diagonal().setConstant(q * dt_s);
      break;
    case TargetKind::kDoubleIntegrator:
      W.diagonal().head(2).setConstant(q * dt_s * dt_s * dt_s / 3.0);
      W.diagonal().tail(2).setConstant(q * dt_s);
      W.topRightCorner(2, 2).diagonal().setConstant(q * dt_s * dt_s / 2.0);
      W.bottomLeftCorner(2, 2).diagonal().setConstant(q * dt_s * dt_s / 2.0);
      break;
    case TargetKind::kGrowingUncertainty:
      W.diagonal().setConstant(q * steps_unseen);
      break;
  }
  return W;
}

}  // namespace vantage::models
