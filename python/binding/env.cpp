#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include <pybind11/stl.h>

#include "core/check.hpp"
#include "logs/picture/picture.hpp"
#include "python/binding/bind.hpp"
#include "python/task/mapping_task.hpp"
#include "python/task/task_picture.hpp"
#include "python/task/team_planner.hpp"
#include "python/task/tracking_task.hpp"
#include "python/task/vector_task.hpp"

namespace vantage::python {
namespace {

// Reader of named options from a dict. finish() throws for names that were not read.
class Options {
 public:
  explicit Options(const py::dict& options) : left_(options.attr("copy")()) {}
  template <class Value>
  void take(const char* name, Value& value) {
    known_ += std::string(known_.empty() ? "" : ", ") + name;
    if (!left_.contains(name)) {
      return;
    }
    const py::object given = left_.attr("pop")(name);
    try {
      value = py::cast<Value>(given);
    } catch (const py::cast_error&) {
      throw UsageError(std::string(name) + ": must be " + word_of<Value>() + ", got " +
                       py::cast<std::string>(py::repr(given)));
    }
  }
  void finish() const {
    for (const auto& [name, value] : left_) {
      throw UsageError("unknown option " + py::cast<std::string>(name) + "; valid options are " +
                       known_);
    }
  }

 private:
  template <class Value>
  static std::string word_of() {
    if constexpr (std::is_same_v<Value, std::string>) {
      return "text";
    } else if constexpr (std::is_floating_point_v<Value>) {
      return "a number";
    } else {
      return "a whole number";
    }
  }
  py::dict left_;
  std::string known_;
};

void take_jammer(Options& options, JammerSpec& jammer) {
  options.take("attacks", jammer.attacks);
  options.take("attack_period_steps", jammer.period_steps);
  std::string attacker = jammer.is_greedy ? "greedy" : "random";
  options.take("attacker", attacker);
  require(attacker == "greedy" || attacker == "random",
          "attacker: must be one of greedy, random, got " + attacker);
  jammer.is_greedy = attacker == "greedy";
}

VectorTask::Make maker(const std::string& kind, const py::dict& given) {
  Options options(given);
  if (kind == "tracking") {
    TrackingSpec spec;
    double fov_deg = degrees(spec.sensor.fov_rad);
    double bearing_sigma_deg = degrees(spec.sensor.bearing_sigma_rad);
    options.take("robots", spec.robots);
    options.take("targets", spec.targets.count);
    options.take("side_m", spec.side_m);
    spec.targets.start_side_m = 0.75 * spec.side_m;
    options.take("start_side_m", spec.targets.start_side_m);
    options.take("q_m2ps3", spec.targets.q_m2ps3);
    options.take("step_s", spec.targets.step_s);
    options.take("prior_position_sigma_m", spec.targets.prior_position_sigma_m);
    options.take("prior_velocity_sigma_mps", spec.targets.prior_velocity_sigma_mps);
    options.take("detection_probability", spec.targets.detection_probability);
    options.take("range_max_m", spec.sensor.range_max_m);
    options.take("range_sigma_m", spec.sensor.range_sigma_m);
    options.take("fov_deg", fov_deg);
    options.take("bearing_sigma_deg", bearing_sigma_deg);
    options.take("episode_steps", spec.episode_steps);
    take_jammer(options, spec.jammer);
    options.finish();
    spec.sensor.fov_rad = radians(fov_deg);
    spec.sensor.bearing_sigma_rad = radians(bearing_sigma_deg);
    return [spec] { return std::make_unique<TrackingTask>(spec); };
  }
  require(kind == "mapping", "kind: must be one of tracking, mapping, got " + kind);
  MappingTaskSpec spec;
  options.take("robots", spec.robots);
  options.take("world", spec.world);
  options.take("side_m", spec.side_m);
  options.take("patch_cells", spec.patch_cells);
  options.take("episode_steps", spec.episode_steps);
  take_jammer(options, spec.jammer);
  options.finish();
  return [spec] { return std::make_unique<MappingTask>(spec); };
}

class Tasks {
 public:
  Tasks(const std::string& kind, int count, int threads, const py::dict& options)
      : tasks_(count, threads, maker(kind, options)) {}

  py::array_t<float> reset(
      const py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>& seeds) {
    py::array_t<float> observations = empty_observations();
    const std::span<const std::uint64_t> seed_span(seeds.data(),
                                                   static_cast<std::size_t>(seeds.size()));
    const std::span<float> out(observations.mutable_data(),
                               static_cast<std::size_t>(observations.size()));
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    tasks_.reset(seed_span);
    tasks_.observe(out);
    return observations;
  }

  py::tuple step(
      const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>& actions) {
    py::array_t<float> observations = empty_observations();
    const auto count = static_cast<py::ssize_t>(tasks_.size());
    py::array_t<double> rewards(count);
    py::array_t<bool> is_over(count);
    const std::span<const std::int64_t> action_span(actions.data(),
                                                    static_cast<std::size_t>(actions.size()));
    const std::span<float> out(observations.mutable_data(),
                               static_cast<std::size_t>(observations.size()));
    const std::span<double> reward_span(rewards.mutable_data(), tasks_.size());
    const std::span<bool> over_span(is_over.mutable_data(), tasks_.size());
    {
      const py::gil_scoped_release release;
      const std::lock_guard lock(mutex_);
      tasks_.step(action_span, reward_span, over_span);
      tasks_.observe(out);
    }
    return py::make_tuple(observations, rewards, is_over);
  }

  // Draws one task into the file `svg_path` and renders it as `png_path`.
  void picture(std::size_t index, const std::string& title, const std::string& svg_path,
               const std::string& png_path) {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    require(index < tasks_.size(), "index: must be below the number of tasks");
    require(tasks_.was_reset(), "reset() must be called before the first picture");
    std::ofstream(svg_path) << pictures_[index].draw(tasks_.task(index), title);
    const Result<std::string> rendered = logs::render_png(svg_path, png_path);
    if (!rendered.ok()) {
      throw std::runtime_error(rendered.error().message);
    }
  }

  template <class Action>
  auto exclusively(const Action& action) const {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return action(tasks_);
  }

  [[nodiscard]] const TeamTask& first() const { return tasks_.task(0); }
  [[nodiscard]] std::size_t size() const { return tasks_.size(); }

 private:
  [[nodiscard]] py::array_t<float> empty_observations() const {
    return py::array_t<float>({static_cast<py::ssize_t>(tasks_.size()),
                               static_cast<py::ssize_t>(first().robots()),
                               static_cast<py::ssize_t>(first().observation_size())});
  }

  mutable std::mutex mutex_;
  VectorTask tasks_;
  std::map<std::size_t, TaskPicture> pictures_;  ///< by index of the task
};

const TeamTask& task_at(const VectorTask& tasks, std::size_t index) {
  require(index < tasks.size(), "index: must be below the number of tasks");
  return tasks.task(index);
}

// Returns the team's estimates in one task and their true errors, for pictures and tests.
// Long function: it fills a dict, key by key.
py::dict state_of(const Tasks& tasks, std::size_t index) {
  struct State {
    std::vector<Pose2> poses;
    std::vector<char> jammed;
    double entropy_nats = 0.0;
    int steps = 0;
    std::vector<models::Gaussian> beliefs;
    std::vector<experiments::TargetStep> targets;
    std::optional<models::OccupancyBelief> map;
  };
  const State state = tasks.exclusively([&](const VectorTask& all) {
    const TeamTask& task = task_at(all, index);
    State now;
    now.jammed = task.jammed();
    now.entropy_nats = task.entropy_nats();
    now.steps = task.steps();
    if (const auto* tracking = dynamic_cast<const TrackingTask*>(&task)) {
      now.poses = tracking->poses();
      now.beliefs = tracking->targets().beliefs();
      now.targets = tracking->targets().steps();
    } else if (const auto* mapping = dynamic_cast<const MappingTask*>(&task)) {
      now.poses = mapping->ground().poses();
      now.map = mapping->ground().map();
    }
    return now;
  });
  py::dict out;
  out["poses"] = poses_array(state.poses, state.poses.size());
  py::array_t<bool> jammed(static_cast<py::ssize_t>(state.jammed.size()));
  for (std::size_t i = 0; i < state.jammed.size(); ++i) {
    jammed.mutable_at(static_cast<py::ssize_t>(i)) = state.jammed[i] != 0;
  }
  out["jammed"] = jammed;
  out["entropy_nats"] = state.entropy_nats;
  out["steps"] = state.steps;
  if (state.map) {
    const models::GridGeometry& grid = state.map->geometry();
    py::array_t<double> map(
        {static_cast<py::ssize_t>(grid.rows), static_cast<py::ssize_t>(grid.columns)});
    for (int cell = 0; cell < grid.size(); ++cell) {
      map.mutable_data()[cell] = state.map->occupancy(cell);
    }
    out["map"] = map;
    out["map_resolution_m"] = grid.resolution_m;
    return out;
  }
  const auto count = static_cast<py::ssize_t>(state.beliefs.size());
  py::array_t<double> means({count, py::ssize_t{4}});
  py::array_t<double> covariances({count, py::ssize_t{4}, py::ssize_t{4}});
  py::array_t<double> errors_m(count);
  py::array_t<bool> seen(count);
  for (py::ssize_t m = 0; m < count; ++m) {
    const auto at = static_cast<std::size_t>(m);
    for (py::ssize_t i = 0; i < 4; ++i) {
      means.mutable_at(m, i) = state.beliefs[at].mean(i);
      for (py::ssize_t j = 0; j < 4; ++j) {
        covariances.mutable_at(m, i, j) = state.beliefs[at].covariance(i, j);
      }
    }
    errors_m.mutable_at(m) = state.targets[at].error_m;
    seen.mutable_at(m) = state.targets[at].is_seen;
  }
  out["means"] = means;
  out["covariances"] = covariances;
  out["errors_m"] = errors_m;
  out["seen"] = seen;
  return out;
}

// Returns the pixels of a PNG with 8 bits per channel from its decompressed rows.
// Source: PNG specification, second edition, section 9.
py::array_t<std::uint8_t> unfiltered_png(std::string_view rows, py::ssize_t height,
                                         py::ssize_t width, py::ssize_t channels) {
  require(height > 0 && width > 0 && channels > 0 &&
              static_cast<py::ssize_t>(rows.size()) == height * (1 + width * channels),
          "PNG: the rows must have the size of the picture");
  py::array_t<std::uint8_t> picture({height, width, channels});
  const py::ssize_t row_bytes = width * channels;
  std::uint8_t* out = picture.mutable_data();
  for (py::ssize_t y = 0; y < height; ++y, out += row_bytes) {
    const auto* const row =
        reinterpret_cast<const std::uint8_t*>(rows.data()) + y * (1 + row_bytes);
    require(row[0] <= 4, "PNG: a row's filter must be 0 to 4");
    for (py::ssize_t i = 0; i < row_bytes; ++i) {
      const int left = i >= channels ? out[i - channels] : 0;
      const int above = y > 0 ? out[i - row_bytes] : 0;
      const int corner = y > 0 && i >= channels ? out[i - row_bytes - channels] : 0;
      const int to_left = std::abs(above - corner);
      const int to_above = std::abs(left - corner);
      const int to_corner = std::abs(left + above - 2 * corner);
      const int nearest = to_left <= to_above && to_left <= to_corner ? left
                          : to_above <= to_corner                     ? above
                                                                      : corner;
      const int guesses[] = {0, left, above, (left + above) / 2, nearest};
      out[i] = static_cast<std::uint8_t>(row[1 + i] + guesses[row[0]]);
    }
  }
  return picture;
}

class Baseline {
 public:
  Baseline(const std::shared_ptr<Tasks>& tasks, const TeamPlannerSpec& spec)
      : tasks_(tasks), planner_(make_team_planner(tasks->first(), spec)) {}

  // Returns controls by [robot][step]; the lists may have different lengths.
  std::vector<std::vector<std::int64_t>> plan(std::size_t index) {
    return tasks_->exclusively(
        [&](const VectorTask& all) { return planner_->plan(task_at(all, index)); });
  }

 private:
  std::shared_ptr<Tasks> tasks_;
  std::unique_ptr<TeamPlanner> planner_;
};

}  // namespace

void bind_env(py::module_& module) {
  module.def("_unfilter_png", &unfiltered_png, py::arg("rows"), py::arg("height"), py::arg("width"),
             py::arg("channels"), "Returns the pixels (height, width, channels) of a PNG's rows.");
  py::class_<Tasks, std::shared_ptr<Tasks>>(module, "_Tasks", "See vantage.env.")
      .def(py::init<const std::string&, int, int, const py::dict&>(), py::arg("kind"),
           py::arg("count"), py::arg("threads"), py::arg("options"))
      .def("reset", &Tasks::reset, py::arg("seeds"))
      .def("step", &Tasks::step, py::arg("actions"))
      .def("state", &state_of, py::arg("index"))
      .def("picture", &Tasks::picture, py::arg("index"), py::arg("title"), py::arg("svg_path"),
           py::arg("png_path"))
      .def_property_readonly("count", &Tasks::size)
      .def_property_readonly("robots", [](const Tasks& t) { return t.first().robots(); })
      .def_property_readonly("actions", [](const Tasks& t) { return t.first().actions(); })
      .def_property_readonly("episode_steps", [](const Tasks& t) { return t.first().steps_max(); })
      .def_property_readonly("observation_size",
                             [](const Tasks& t) { return t.first().observation_size(); })
      .def_property_readonly("observation_parts", [](const Tasks& t) {
        std::vector<std::pair<std::string, std::vector<int>>> out;
        for (const ObservationPart& part : t.first().observation_parts()) {
          out.emplace_back(part.name, part.shape);
        }
        return out;
      });
  py::class_<Baseline>(module, "_Baseline", "See vantage.env.baselines.")
      .def(py::init([](const std::shared_ptr<Tasks>& tasks, const std::string& algorithm,
                       int horizon_steps, std::int64_t nodes) {
             return std::make_unique<Baseline>(tasks,
                                               TeamPlannerSpec{algorithm, horizon_steps, nodes});
           }),
           py::arg("tasks"), py::arg("algorithm"), py::arg("horizon_steps"), py::arg("nodes"))
      .def("plan", &Baseline::plan, py::arg("index"));
}

}  // namespace vantage::python
