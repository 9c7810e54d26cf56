// instruction_count [CASE]: runs one case once, in a function that a profiler can select, and
// prints how many units of work it did. Without an argument it lists the cases. tools/dev/count
// runs it under callgrind and compares instructions per unit with a committed table.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/node/bus.hpp"
#include "planner/search/arvi.hpp"
#include "planner/search/catalogue.hpp"
#include "test/bench/field_problem.hpp"
#include "test/bench/filter_family.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/vicon/object_stream.hpp"

/// Function in which instructions are counted. tools/dev/count selects it by its name.
extern "C" [[gnu::noinline]] std::int64_t vantage_counted(
    const std::function<std::int64_t()>& work) {
  const std::int64_t units = work();
  asm volatile("" ::: "memory");  // keeps the call above from becoming a jump
  return units;
}

namespace vantage::bench {
namespace {

/// Function that works and returns the number of completed units of work.
using Work = std::function<std::int64_t()>;

struct Case {
  std::string name;
  std::string unit;
  std::function<Work()> prepare;
};

constexpr int kTargets[] = {1, 9, 25};
constexpr std::uint64_t kProblems = 8;
constexpr int kMessages = 1000;
constexpr int kSteps = 50;

/// Plans every problem of the field family with `options`; one unit is a generated node.
Work search_work(int targets, int horizon_steps, const planner::ReducedOptions& options,
                 std::int64_t nodes_max) {
  auto problems = std::make_shared<std::vector<planner::SearchProblem>>();
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    problems->push_back(field_problem(targets, horizon_steps, seed));
  }
  const auto search = std::make_shared<planner::ReducedValueIteration>(
      planner::SearchCapacity{400'000, 8'000'000, targets, 16, 1});
  return [=] {
    std::int64_t nodes = 0;
    for (const planner::SearchProblem& problem : *problems) {
      const Deadline deadline = nodes_max > 0 ? Deadline::nodes(nodes_max) : Deadline::never();
      nodes += search->plan(problem, options, deadline).nodes_generated;
    }
    return nodes;
  };
}

/// Plans like search_work(), with the search `name` of the catalogue.
Work catalogue_work(const char* name, int targets, std::int64_t nodes_max) {
  auto problems = std::make_shared<std::vector<planner::SearchProblem>>();
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    problems->push_back(field_problem(targets, 12, seed));
  }
  const planner::Algorithm& algorithm = planner::algorithm_called(name);
  const std::shared_ptr<planner::Search> search =
      algorithm.make({400'000, 8'000'000, targets, 16, 1}, {});
  return [=] {
    std::int64_t nodes = 0;
    for (const planner::SearchProblem& problem : *problems) {
      nodes += search->plan(problem, Deadline::nodes(nodes_max)).nodes_generated;
    }
    return nodes;
  };
}

/// Runs the filter; one unit is a step. The messages of each step are made in the counted function
/// too; their cost is the same for each build.
Work filter_work(const FilterCase& filter_case) {
  const auto run = std::make_shared<FilterRun>(filter_case);
  return [run] {
    for (int k = 0; k < kSteps; ++k) {
      run->prepare_step();
      run->step();
    }
    return std::int64_t{kSteps};
  };
}

/// Publishes and receives `message`; one unit is a message.
template <class Message>
Work bus_work(const bus::Channel<Message>& channel, const Message& message) {
  struct Ends {
    bus::InProcessHub hub;
    std::unique_ptr<bus::Transport> near = hub.connect();
    std::unique_ptr<bus::Transport> far = hub.connect();
    bus::Bus sender{*near, 1};
    bus::Bus receiver{*far, 2};
    std::int64_t received = 0;
  };
  const auto ends = std::make_shared<Ends>();
  ends->receiver.template subscribe<Message>(
      channel, [raw = ends.get()](const Message&) { ++raw->received; });
  return [ends, channel, message] {
    ends->received = 0;
    for (int i = 0; i < kMessages; ++i) {
      ends->sender.publish(channel, message);
      ends->receiver.handle(std::chrono::microseconds(0));
    }
    return ends->received;
  };
}

models::MocapFrame mocap_frame() {
  models::MocapFrame frame;
  frame.stamp.time = frame.arrival = from_utime(1'000'000'000);
  for (int i = 0; i < 8; ++i) {
    frame.bodies.push_back({"B" + std::to_string(i), Pose3{}, false});
  }
  return frame;
}

models::RobotPlan plan() {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.stamp.time = plan.trajectory.start_time = from_utime(1'000'000'000);
  plan.trajectory.segments.resize(20, {{0.5, 0.1}, 0.5, 0.0});
  return plan;
}

models::RobotBelief belief() {
  FilterRun run(filter_cases().front());
  run.prepare_step();
  run.step();
  return run.filter().belief();
}

/// Decodes a stream of attitude messages; one unit is a message.
Work mavlink_work() {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < kMessages; ++i) {
    wire::mavlink::Attitude attitude;
    attitude.yawspeed = 0.25F;
    wire::mavlink::append_bytes(wire::mavlink::pack(attitude, {1, 1, static_cast<std::uint8_t>(i)}),
                                bytes);
  }
  return [bytes] {
    wire::mavlink::Parser parser;
    std::int64_t messages = 0;
    parser.feed(bytes, [&](const wire::mavlink::Frame& frame) {
      messages += wire::mavlink::unpack<wire::mavlink::Attitude>(frame) ? 1 : 0;
    });
    return messages;
  };
}

/// Decodes a datagram of eight objects; one unit is a datagram.
Work object_stream_work() {
  wire::vicon::ObjectBlock block;
  for (int i = 0; i < 8; ++i) {
    block.objects.emplace_back().set_name("B" + std::to_string(i));
  }
  std::vector<std::uint8_t> datagram;
  wire::vicon::encode_object_block(block, 1024, datagram);
  return [datagram] {
    wire::vicon::ObjectBlock decoded;
    std::int64_t datagrams = 0;
    for (int i = 0; i < kMessages; ++i) {
      datagrams += wire::vicon::decode_object_block(datagram, decoded) ? 1 : 0;
    }
    return datagrams;
  };
}

planner::ReducedOptions forward_options() {
  planner::ReducedOptions options;
  options.search = planner::ReducedSearch::kExhaustive;
  return options;
}

planner::ReducedOptions reduced_options() {
  planner::ReducedOptions options;
  options.search = planner::ReducedSearch::kSinglePass;
  options.epsilon = std::numeric_limits<double>::infinity();
  options.delta_m = 0.663;
  options.yaw_weight_m_per_rad = 0.0;
  return options;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const int targets : kTargets) {
    const std::string end = "-" + std::to_string(targets);
    all.push_back({"search-forward" + end, "node",
                   [=] { return search_work(targets, 5, forward_options(), 0); }});
    all.push_back({"search-reduced" + end, "node",
                   [=] { return search_work(targets, 12, reduced_options(), 0); }});
    all.push_back(
        {"search-anytime" + end, "node", [=] { return search_work(targets, 12, {}, 20'000); }});
    all.push_back(
        {"search-beam" + end, "node", [=] { return catalogue_work("beam", targets, 20'000); }});
  }
  for (const FilterCase& each : filter_cases()) {
    std::string name = std::string("filter-") + each.name + "-" + std::to_string(each.targets);
    std::replace(name.begin(), name.end(), ' ', '-');
    all.push_back({name, "step", [&each] { return filter_work(each); }});
  }
  all.push_back({"bus-mocap", "message", [] { return bus_work(bus::kVicon, mocap_frame()); }});
  all.push_back({"bus-plan", "message", [] { return bus_work(bus::plan_channel("Q1"), plan()); }});
  all.push_back(
      {"bus-belief", "message", [] { return bus_work(bus::belief_channel("Q0"), belief()); }});
  all.push_back({"mavlink-decode", "message", mavlink_work});
  all.push_back({"object-stream-decode", "datagram", object_stream_work});
  return all;
}

int list() {
  for (const Case& each : cases()) {
    std::printf("%s\t%s\n", each.name.c_str(), each.unit.c_str());
  }
  return 0;
}

int run(std::string_view name) {
  for (const Case& each : cases()) {
    if (each.name == name) {
      const Work work = each.prepare();
      work();  // this first run reserves memory
      std::printf("%lld\n", static_cast<long long>(vantage_counted(work)));
      return 0;
    }
  }
  std::fprintf(stderr, "instruction_count: unknown case '%s'\n", std::string(name).c_str());
  return 2;
}

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  return argc < 2 ? vantage::bench::list() : vantage::bench::run(argv[1]);
}
