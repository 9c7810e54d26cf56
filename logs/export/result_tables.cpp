#include "logs/export/result_tables.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "logs/export/csv_file.hpp"
#include "logs/file/message_visit.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/truth_history.hpp"

namespace vantage::logs {
namespace {

constexpr Duration kTruthPatience = std::chrono::seconds(5);

std::string number_or_empty(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : std::string();
}

/// Writer of all tables. A belief is written when the truth of its time has arrived, or after
/// kTruthPatience.
class Tables {
 public:
  Tables(const scenario::Scenario& scenario, const std::string& folder, Time begin)
      : scenario_(scenario),
        begin_(begin),
        estimates_(folder + "/estimates.csv", "t_s,robot,target,x_m,y_m,sigma_m,error_m\n"),
        plans_(folder + "/plans.csv",
               "t_s,robot,round,source,late,cost_nat,lower_bound_nat,nodes,margin_s\n"),
        vehicles_(folder + "/vehicles.csv", "t_s,robot,state,battery_share,reasons\n"),
        poses_(folder + "/poses.csv", "t_s,body,x_m,y_m,z_m,yaw_deg\n"),
        contacts_(folder + "/contacts.csv", "t_s,kind,body_a,body_b,distance_m\n") {}

  template <class Message>
  bool on(const Message& /*message*/) {
    return false;
  }
  bool on(const models::TruthFrame& truth) {
    truth_.add(truth);
    newest_truth_ = std::max(newest_truth_.value_or(truth.stamp.time), truth.stamp.time);
    write_estimates();
    return false;
  }
  bool on(const models::RobotBelief& belief) {
    newest_belief_ = std::max(newest_belief_.value_or(belief.stamp.time), belief.stamp.time);
    pending_.push_back(belief);
    write_estimates();
    return true;
  }
  bool on(const models::RobotPlan& plan) {
    plans_.write(fmt::format("{:.3f},{},{},{},{:d},{},{},{},{:.4f}\n", t_s(plan.stamp.time),
                             csv_cell(plan.robot), models::round_text(plan.round),
                             name_of(plan.source), plan.late, number_or_empty(plan.cost, "{:.4f}"),
                             number_or_empty(plan.lower_bound, "{:.4f}"), plan.nodes,
                             to_seconds(plan.deadline - plan.finish)));
    return true;
  }
  bool on(const models::VehicleStatus& status) {
    vehicles_.write(fmt::format("{:.3f},{},{},{:.3f},{}\n", t_s(status.stamp.time),
                                csv_cell(status.robot), name_of(status.state), status.battery_share,
                                csv_cell(fmt::format("{}", fmt::join(status.reasons, "; ")))));
    return true;
  }
  bool on(const models::MocapFrame& frame) {
    for (const models::MocapBody& body : frame.bodies) {
      if (!body.occluded) {
        const Eigen::Vector3d& at_m = body.world_from_body.translation_m;
        poses_.write(fmt::format("{:.3f},{},{:.4f},{:.4f},{:.4f},{:.2f}\n", t_s(frame.stamp.time),
                                 csv_cell(body.name), at_m.x(), at_m.y(), at_m.z(),
                                 degrees(flatten(body.world_from_body).yaw_rad)));
      }
    }
    return true;
  }
  bool on(const models::CollisionReport& contact) {
    const bool is_collision = contact.kind == models::CollisionKind::kCollision;
    contacts_.write(fmt::format("{:.3f},{},{},{},{:.3f}\n", t_s(contact.stamp.time),
                                is_collision ? "collision" : "near miss", csv_cell(contact.body_a),
                                csv_cell(contact.body_b), contact.distance_m));
    return true;
  }

  [[nodiscard]] std::string failure() const {
    for (const CsvFile* file : {&estimates_, &plans_, &vehicles_, &poses_, &contacts_}) {
      if (!file->failure().empty()) {
        return file->failure();
      }
    }
    return "";
  }
  /// Writes the pending beliefs and closes the tables.
  void finish() {
    while (!pending_.empty()) {
      write(pending_.front());
      pending_.pop_front();
    }
    for (CsvFile* file : {&estimates_, &plans_, &vehicles_, &poses_, &contacts_}) {
      file->close();
    }
  }

 private:
  [[nodiscard]] double t_s(Time time) const { return to_seconds(time - begin_); }

  [[nodiscard]] std::string target_name(int id) const {
    const auto found =
        std::find_if(scenario_.targets.begin(), scenario_.targets.end(),
                     [id](const scenario::TargetSpec& target) { return target.id == id; });
    return found == scenario_.targets.end() ? std::to_string(id) : found->name;
  }

  void write_estimates() {
    while (!pending_.empty()) {
      const Time time = pending_.front().stamp.time;
      const bool has_truth = newest_truth_ && *newest_truth_ >= time;
      if (!has_truth && *newest_belief_ - time < kTruthPatience) {
        return;
      }
      write(pending_.front());
      pending_.pop_front();
    }
  }

  void write(const models::RobotBelief& belief) {
    for (const models::TargetBelief& target : belief.targets) {
      const auto estimate = position_estimate(target, belief.robot, belief.stamp.time,
                                              scenario_.estimator.target_model.position_dim);
      if (!estimate) {
        continue;
      }
      const auto truth_m = truth_.target_position_m(target.target_id, belief.stamp.time);
      const std::string error =
          truth_m ? fmt::format("{:.4f}", (truth_m->head<2>() - estimate->mean_m.head<2>()).norm())
                  : std::string();
      estimates_.write(fmt::format("{:.3f},{},{},{:.4f},{:.4f},{:.4f},{}\n", t_s(belief.stamp.time),
                                   csv_cell(belief.robot), csv_cell(target_name(target.target_id)),
                                   estimate->mean_m(0), estimate->mean_m(1), estimate->sigma_m(),
                                   error));
    }
  }

  const scenario::Scenario& scenario_;
  Time begin_;
  CsvFile estimates_;
  CsvFile plans_;
  CsvFile vehicles_;
  CsvFile poses_;
  CsvFile contacts_;
  TruthHistory truth_;
  std::optional<Time> newest_truth_;
  std::optional<Time> newest_belief_;
  std::deque<models::RobotBelief> pending_;  ///< beliefs that wait for the truth of their time
};

}  // namespace

ExportCounts export_results(const IndexedLog& log, const scenario::Scenario& scenario,
                            const std::string& folder, const std::function<void(double)>& progress,
                            const std::function<bool()>& stop) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw StartupError(folder + ": cannot be created: " + error.message());
  }
  Tables tables(scenario, folder, log.survey().begin);
  ExportCounts counts;
  LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    counts.is_stopped = stop();
    if (counts.is_stopped || !tables.failure().empty()) {
      break;
    }
    if (progress && scan.counts().events % kEventsPerReport == 0) {
      progress(static_cast<double>(event->offset) / static_cast<double>(log.bytes().size()));
    }
    visit_message(*event,
                  [&](const auto& message) { counts.messages += tables.on(message) ? 1U : 0U; });
  }
  tables.finish();
  counts.failure = tables.failure();
  if (progress) {
    progress(1.0);
  }
  return counts;
}

}  // namespace vantage::logs
