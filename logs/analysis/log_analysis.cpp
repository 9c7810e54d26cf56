#include "logs/analysis/log_analysis.hpp"

#include <algorithm>
#include <cmath>

#include "core/utf8.hpp"
#include "logs/file/message_visit.hpp"
#include "logs/metrics/origin_times.hpp"
#include "logs/metrics/trial_metrics.hpp"

namespace vantage::logs {
namespace {

class Analyst {
 public:
  Analyst(const scenario::Scenario& scenario, Time start)
      : metrics_(scenario, start),
        sets_(static_cast<int>(scenario.targets.size())),
        start_(start) {}

  /// Sets the channel and the logging time of the next message.
  void now(std::string_view channel, Time logged) {
    channel_ = channel;
    logged_ = logged;
  }

  void on(const models::TruthFrame& truth) {
    metrics_.on_truth(truth);
    sets_.on_truth(truth);
  }
  void on(const models::CollisionReport& contact) { metrics_.on_contact(contact); }
  void on(const models::VehicleStatus& status) { metrics_.on_vehicle(status); }
  void on(const models::ProcessHealth& health) {
    metrics_.on_health(health);
    if (std::vector<Hop> hops = hops_of(health); !hops.empty()) {
      analysis_.hops[health.process] = std::move(hops);
    }
  }
  void on(const models::AttackNotice& /*attack*/) {}
  void on(const models::OdometryReport& /*odometry*/) {}
  void on(const models::SightingReport& /*sightings*/) {}
  void on(const models::PoseEstimate& estimate) { metrics_.on_pose(estimate); }
  void on(const models::PlanProposal& /*proposal*/) {}
  void on(const models::TeamProposal& /*proposal*/) {}
  void on(const models::BeliefMixture& /*mixture*/) {
  }  // not evaluated: the RobotBelief of the same step is evaluated
  void on(const models::CompactBelief& /*belief*/) {}  // the RobotBelief is evaluated instead
  void on(const models::RangeScan& /*scan*/) {}
  void on(const models::RobotMap& map) { metrics_.on_map(map); }
  void on(const models::OperatorCommand& /*command*/) {}
  void on(const models::HostReport& /*report*/) {}
  void on(const models::ScenarioNotice& /*notice*/) {}

  void on(const models::MocapFrame& frame) {
    latencies_s_["capture → arrival"].push_back(to_seconds(frame.arrival - frame.stamp.time));
    latencies_s_["capture → log"].push_back(to_seconds(logged_ - frame.stamp.time));
  }

  void on(const models::RobotMeasurement& scan) {
    scans_.add(models::ref_to(std::string(channel_), scan.stamp), scan.stamp.time);
  }

  void on(const models::RobotBelief& belief) {
    metrics_.on_belief(belief);
    sets_.on_belief(belief);
    const models::InputRef name = models::ref_to(std::string(channel_), belief.stamp);
    beliefs_.add(name, belief.stamp.time);
    if (const auto scan = scans_.newest(belief.inputs)) {
      latencies_s_["look → belief"].push_back(to_seconds(logged_ - *scan));
      scans_of_beliefs_.add(name, *scan);
    }
    note_course(belief.step);
  }

  void on(const models::RobotPlan& plan) {
    metrics_.on_plan(plan);
    if (const auto belief = beliefs_.newest(plan.inputs)) {
      latencies_s_["belief → plan"].push_back(to_seconds(plan.finish - *belief));
    }
    if (const auto scan = scans_of_beliefs_.newest(plan.inputs)) {
      latencies_s_["look → plan"].push_back(to_seconds(plan.finish - *scan));
    }
    DeadlineRecord& record = analysis_.deadlines[plan.robot];
    ++record.plans;
    record.late += plan.late ? 1 : 0;
    record.fallbacks += plan.source == models::PlanSource::kSearched ? 0 : 1;
    const double margin_s = to_seconds(plan.deadline - plan.finish);
    margins_s_[plan.robot].push_back(margin_s);
    searches_s_[plan.robot].push_back(to_seconds(plan.finish - plan.slot_start));
    const double gap_nat = plan.cost - plan.lower_bound;
    analysis_.plans.push_back({to_seconds(logged_ - start_), plan.robot, margin_s,
                               std::isfinite(gap_nat) ? std::optional(gap_nat) : std::nullopt});
  }

  LogAnalysis finish(const LogSurvey& survey) {
    std::int64_t lost = 0;
    for (const auto& [name, channel] : survey.channels) {
      if (channel.messages_lost > 0) {
        analysis_.lost[name] = channel.messages_lost;
        lost += channel.messages_lost;
      }
      if (channel.has_two_publishers) {
        analysis_.contested.push_back(name);
      }
    }
    analysis_.summary = metrics_.finish(survey.end);
    analysis_.sets = sets_.means();
    analysis_.times_outlying = survey.times_outlying;
    analysis_.summary.messages_lost = std::max(analysis_.summary.messages_lost, lost);
    for (auto& [name, values_s] : latencies_s_) {
      analysis_.latencies[name] = spread_of(std::move(values_s));
    }
    for (auto& [robot, record] : analysis_.deadlines) {
      record.margin = spread_of(std::move(margins_s_[robot]));
      record.search = spread_of(std::move(searches_s_[robot]));
    }
    return std::move(analysis_);
  }

 private:
  /// Adds a point with the newest evaluated values, which belong to an earlier step than `step`.
  void note_course(std::int64_t step) {
    if (step <= newest_step_) {
      return;
    }
    newest_step_ = step;
    CoursePoint point;
    point.at_s = to_seconds(logged_ - start_);
    double squared_m2 = 0.0;
    int known = 0;
    for (const TargetStatus& target : metrics_.targets()) {
      point.entropy_nats += target.entropy_nats;
      point.discovered += target.discovered_s ? 1 : 0;
      if (target.error_m) {
        squared_m2 += *target.error_m * *target.error_m;
        ++known;
      }
    }
    const auto targets = static_cast<double>(std::max<std::size_t>(1, metrics_.targets().size()));
    point.entropy_nats /= targets;
    if (known > 0) {
      point.rmse_m = std::sqrt(squared_m2 / known);
    }
    analysis_.course.push_back(point);
  }

  TrialMetrics metrics_;
  SetSums sets_;
  Time start_;
  std::string_view channel_;
  Time logged_{};
  OriginTimes scans_;
  OriginTimes beliefs_;
  OriginTimes scans_of_beliefs_;
  std::int64_t newest_step_ = -1;
  std::map<std::string, std::vector<double>> latencies_s_;
  std::map<std::string, std::vector<double>> margins_s_;
  std::map<std::string, std::vector<double>> searches_s_;
  LogAnalysis analysis_;
};

nlohmann::ordered_json to_json(const Spread& spread) {
  return {{"count", spread.count}, {"mean_s", spread.mean_s},   {"median_s", spread.median_s},
          {"p95_s", spread.p95_s}, {"worst_s", spread.worst_s}, {"least_s", spread.least_s}};
}

}  // namespace

Spread spread_of(std::vector<double> values_s) {
  if (values_s.empty()) {
    return {};
  }
  std::sort(values_s.begin(), values_s.end());
  const auto at_share = [&](double share) {
    return values_s[static_cast<std::size_t>(share * static_cast<double>(values_s.size() - 1))];
  };
  double sum_s = 0.0;
  for (const double value_s : values_s) {
    sum_s += value_s;
  }
  return {std::ssize(values_s), sum_s / static_cast<double>(values_s.size()),
          at_share(0.5),        at_share(0.95),
          values_s.back(),      values_s.front()};
}

std::vector<Hop> hops_of(const models::ProcessHealth& health) {
  constexpr std::string_view kFirst = "_p50_us";
  std::vector<Hop> out;
  const std::vector<models::NamedCount>& all = health.counters;
  for (std::size_t i = 0; i + 2 < all.size(); ++i) {
    if (all[i].name.ends_with(kFirst)) {
      const std::string name = all[i].name.substr(0, all[i].name.size() - kFirst.size());
      if (all[i + 1].name == name + "_p99_us" && all[i + 2].name == name + "_max_us") {
        const std::string_view words = name.starts_with("latency.") ? "latency." : "";
        out.push_back(
            {name.substr(words.size()), all[i].count, all[i + 1].count, all[i + 2].count});
      }
    }
  }
  return out;
}

LogAnalysis analyse_log(const IndexedLog& log, const scenario::Scenario& scenario,
                        const std::function<void(double)>& progress) {
  Analyst analyst(scenario, log.survey().begin);
  LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (log.survey().is_usual(event->time)) {
      analyst.now(event->channel, event->time);
      visit_message(*event, [&](const auto& message) { analyst.on(message); });
    }
    if (progress && scan.counts().events % kEventsPerReport == 0) {
      progress(static_cast<double>(event->offset) / static_cast<double>(log.bytes().size()));
    }
  }
  if (progress) {
    progress(1.0);
  }
  return analyst.finish(log.survey());
}

nlohmann::ordered_json to_json(const LogAnalysis& analysis) {
  nlohmann::ordered_json json = to_json(analysis.summary);
  if (analysis.sets) {
    json["per_robot"]["ospa_m"] = analysis.sets->ospa_m;
    json["per_robot"]["swaps_per_min"] = analysis.sets->swaps_per_min;
    json["per_robot"]["matched_rmse_m"] = analysis.sets->matched_rmse_m;
  }
  for (const auto& [name, spread] : analysis.latencies) {
    json["latencies"][name] = to_json(spread);
  }
  for (const auto& [process, hops] : analysis.hops) {
    for (const Hop& hop : hops) {
      json["hops"][process][hop.name] = {
          {"p50_us", hop.p50_us}, {"p99_us", hop.p99_us}, {"max_us", hop.max_us}};
    }
  }
  for (const auto& [robot, record] : analysis.deadlines) {
    json["deadlines"][robot] = {{"plans", record.plans},
                                {"late", record.late},
                                {"fallbacks", record.fallbacks},
                                {"margin", to_json(record.margin)},
                                {"search", to_json(record.search)}};
  }
  json["times_outlying"] = analysis.times_outlying;
  json["lost"] = nlohmann::ordered_json::object();
  for (const auto& [channel, lost] : analysis.lost) {
    json["lost"][readable(channel)] = lost;
  }
  return json;
}

}  // namespace vantage::logs
