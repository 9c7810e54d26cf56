#include "experiments/decisions/heterogeneous_summary.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "experiments/decisions/energy_trial.hpp"
#include "experiments/figures.hpp"
#include "experiments/sweep/compare.hpp"

namespace vantage::experiments {
namespace {

// Samples of all trials of one price and method.
struct PointSamples {
  std::map<int, HeterogeneousOutcome> by_trial;
  Sample value;
  Sample information;
  Sample energy;
  Sample energy_ugvs;
  Sample energy_uav;
};
using Curves = std::map<std::string, std::map<std::string, PointSamples>>;  // by method and price

class Summarised {
 public:
  Summarised(const SweepPlan& plan, const Tables& tables) : plan_(plan), tables_(tables) {
    for (const Record& record : tables.at("trials")) {
      const HeterogeneousOutcome outcome{record.number(1), record.number(2), record.number(3),
                                         record.number(4)};
      PointSamples& point = curves_[record.cells[0]][price_of(record)];
      point.by_trial[record.unit.trial] = outcome;
      point.value.add(outcome.value);
      point.information.add(outcome.information);
      point.energy.add(outcome.energy());
      point.energy_ugvs.add(outcome.energy_ugvs);
      point.energy_uav.add(outcome.energy_uav);
      candidates_.add(record.number(5));
    }
    for (const Record& record : tables.at("times")) {
      times_[record.cells[0]].add(record.number(1));
    }
  }

  [[nodiscard]] Summary all() const {
    Summary summary;
    summary.files["summary.csv"] = csv();
    const int trial = pictured_trial();
    add_picture(summary, trial);
    for (std::size_t order = 0; order < 2; ++order) {
      compare(summary, kMethods[order]);
    }
    for (const auto& [price, point] : curves_.at("dls")) {
      summary.lines.push_back(line(price));
    }
    summary.lines.push_back(fmt::format("I and J in nats; the figure shows trial {}", trial));
    const auto mean_s = [&](const char* part) { return times_.at(part).mean(); };
    summary.time_lines.push_back(
        fmt::format("Mean CPU time of a trial: trajectories {:.3f} s, gains of N = {:.0f} "
                    "candidates {:.4f} s, DLS {:.4f} s, CD {:.4f} s",
                    mean_s("trajectories"), candidates_.mean(), mean_s("each alone"), mean_s("dls"),
                    mean_s("cd uav first")));
    return summary;
  }

 private:
  [[nodiscard]] std::string price_of(const Record& record) const {
    return plan_.settings[record.unit.setting].cells;
  }

  [[nodiscard]] std::string csv() const {
    std::string text =
        "price,method,value,value_ci95,information,information_ci95,energy,energy_ci95,energy_ugvs,"
        "energy_uav\n";
    for (const auto& [method, curve] : curves_) {
      for (const auto& [price, p] : curve) {
        text += fmt::format("{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f},{:.4f},{:.4f}\n",
                            price, method, p.value.mean(), p.value.half_interval(),
                            p.information.mean(), p.information.half_interval(), p.energy.mean(),
                            p.energy.half_interval(), p.energy_ugvs.mean(), p.energy_uav.mean());
      }
    }
    return text;
  }

  // Returns for each trial J of DLS minus `other`(trial).
  template <class Other>
  [[nodiscard]] Sample gap(const std::string& price, const Other& other) const {
    Sample sample;
    for (const auto& [trial, outcome] : curves_.at("dls").at(price).by_trial) {
      sample.add(outcome.value - other(trial));
    }
    return sample;
  }
  [[nodiscard]] Sample gap_to(const std::string& price, const char* method) const {
    const auto& other = curves_.at(method).at(price).by_trial;
    return gap(price, [&](int trial) { return other.at(trial).value; });
  }
  [[nodiscard]] double better_descent(const std::string& price, int trial) const {
    return std::max(curves_.at(kMethods[0].name).at(price).by_trial.at(trial).value,
                    curves_.at(kMethods[1].name).at(price).by_trial.at(trial).value);
  }

  // Returns the mean information of DLS at mean energy `energy`, interpolated between its points
  // and the origin.
  [[nodiscard]] double dls_information_at(double energy) const {
    std::map<double, double> curve = {{0.0, 0.0}};
    for (const auto& [price, point] : curves_.at("dls")) {
      curve[point.energy.mean()] = point.information.mean();
    }
    const auto after = curve.lower_bound(energy);
    if (after == curve.end()) {
      return curve.rbegin()->second;
    }
    if (after == curve.begin()) {
      return after->second;
    }
    const auto before = std::prev(after);
    const double share = (energy - before->first) / (after->first - before->first);
    return before->second + share * (after->second - before->second);
  }

  void compare(Summary& summary, const HeterogeneousMethod& method) const {
    Sample above;  // curve of DLS minus the points of `method`, nats
    int higher = 0;
    int better = 0;
    int surely_better = 0;
    for (const auto& [price, point] : curves_.at(method.name)) {
      above.add(dls_information_at(point.energy.mean()) - point.information.mean());
      higher += dls_information_at(point.energy.mean()) >= point.information.mean() ? 1 : 0;
      const Sample gain = gap_to(price, method.name);
      better += gain.mean() >= 0.0 ? 1 : 0;
      surely_better += gain.mean() > gain.half_interval() ? 1 : 0;
    }
    const auto points = static_cast<int>(above.size());
    summary.compared.push_back(
        compare_claim(fmt::format("mean information of DLS at the mean energy of {}", method.label),
                      fmt::format("not lower at {} of {} points; mean difference {:+.2f} nats",
                                  higher, points, above.mean()),
                      "DLS consistently better", higher == points));
    summary.compared.push_back(
        compare_claim(fmt::format("mean J of DLS minus that of {}, paired by trial", method.label),
                      fmt::format("≥ 0 at {} of {} prices; the interval is above 0 at {} of them",
                                  better, points, surely_better),
                      "better on average", better == points));
    const Sample pictured = gap_to(kPicturedPrice, method.name);
    summary.compared.push_back(compare_claim(
        fmt::format("mean difference of J at the energy price r = {}", kPicturedPrice),
        mean_text(pictured) + " nats", "> 0 in Fig. 3.9", pictured.mean() > 0.0));
  }

  [[nodiscard]] std::string line(const std::string& price) const {
    std::string text = fmt::format("r = {}:", price);
    for (const HeterogeneousMethod& method : kMethods) {
      const PointSamples& p = curves_.at(method.name).at(price);
      text += fmt::format(
          " {}: information I = {:.2f} nats, energy C = {:.1f} ({:.1f} for UAVs), value J = "
          "{:.2f};",
          method.label, p.information.mean(), p.energy.mean(), p.energy_uav.mean(), p.value.mean());
    }
    const Sample gain = gap(price, [&](int trial) { return better_descent(price, trial); });
    return text + fmt::format(" DLS minus the better order of CD per trial {}", mean_text(gain));
  }

  // Returns the trial in which DLS gains most over the better order of coordinate descent.
  [[nodiscard]] int pictured_trial() const {
    const auto& dls = curves_.at("dls").at(kPicturedPrice).by_trial;
    const auto gain = [&](const auto& of) {
      return of.second.value - better_descent(kPicturedPrice, of.first);
    };
    return std::max_element(dls.begin(), dls.end(),
                            [&](const auto& a, const auto& b) { return gain(a) < gain(b); })
        ->first;
  }

  // Adds gnuplot blocks: one path per method and robot, and the targets of each method.
  void add_picture(Summary& summary, int trial) const {
    std::string titles;
    for (const HeterogeneousMethod& method : kMethods) {
      for (const char robot : {'0', '1', '2'}) {
        summary.files["ways.txt"] +=
            block("ways", trial, {method.name, std::string(1, robot)}) + "\n\n";
      }
      summary.files["targets.txt"] += block("targets", trial, {method.name}) + "\n\n";
      const HeterogeneousOutcome& of =
          curves_.at(method.name).at(kPicturedPrice).by_trial.at(trial);
      titles += fmt::format("\"{}: J = {:.1f}, I = {:.1f} nats, C = {:g}\" ", method.label,
                            of.value, of.information, of.energy());
    }
    summary.figure_script = heterogeneous_figures(heterogeneous_world(), titles);
    summary.figures = {"heterogeneous", "heterogeneous-ways"};
  }

  // Returns the rows of a table that begin with the cells `keys`, without these cells.
  [[nodiscard]] std::string block(const char* table, int trial,
                                  const std::vector<std::string>& keys) const {
    std::string text;
    for (const Record& record : tables_.at(table)) {
      if (record.unit.trial == trial &&
          std::equal(keys.begin(), keys.end(), record.cells.begin())) {
        const auto first = record.cells.begin() + static_cast<std::ptrdiff_t>(keys.size());
        text += fmt::format("{}\n", fmt::join(first, record.cells.end(), " "));
      }
    }
    return text;
  }

  const SweepPlan& plan_;
  const Tables& tables_;
  Curves curves_;
  Sample candidates_;
  std::map<std::string, Sample> times_;
};

}  // namespace

Summary summarise_heterogeneous(const SweepPlan& plan, const Tables& tables) {
  return Summarised(plan, tables).all();
}

}  // namespace vantage::experiments
