#include "planner/decision/local_search_session.hpp"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::planner {
namespace {

// α of the improvement rule. Its N is the number of candidates of the whole team, which is unknown.
// α is therefore negligible, and only kLeastRise_nats is effective.
constexpr double kAlpha = 1e-12;

// FNV-1a hash, 64 bits.
class Hash {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
      state_ = (state_ ^ ((word >> (8 * byte)) & 0xFFU)) * 0x100000001b3U;
    }
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const std::string& text) {
    for (const char c : text) {
      add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
    }
  }
  [[nodiscard]] std::int64_t value() const { return std::bit_cast<std::int64_t>(state_); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325U;
};

}  // namespace

std::int64_t fingerprint(const models::TeamChoice& choice) {
  Hash hash;
  hash.add(choice.robot);
  const models::Trajectory& motion = choice.trajectory;
  for (const double number :
       {motion.start.x_m, motion.start.y_m, motion.start.yaw_rad, motion.height_m}) {
    hash.add(number);
  }
  for (const models::PlanSegment& segment : motion.segments) {
    for (const double number : {segment.control.speed_mps, segment.control.yaw_rate_radps,
                                segment.duration_s, segment.brake_mps2}) {
      hash.add(number);
    }
  }
  return hash.value();
}

std::int64_t fingerprint(const std::vector<std::string>& robots,
                         const std::vector<models::TeamChoice>& choices) {
  Hash hash;
  for (const std::string& robot : robots) {
    const auto choice = std::find_if(choices.begin(), choices.end(),
                                     [&](const auto& each) { return each.robot == robot; });
    hash.add(choice == choices.end() ? std::uint64_t{0}
                                     : std::bit_cast<std::uint64_t>(fingerprint(*choice)));
  }
  return hash.value();
}

double information_alone(const TeamProblem& problem, const Candidate& candidate) {
  TeamProblem alone{problem.targets, problem.horizon_steps, problem.step_s, problem.measure, {}};
  alone.candidates = {{candidate}};
  alone.candidates[0][0].energy_cost = 0.0;
  alone.candidates[0][0].unshared_nats = 0.0;
  return TeamOracle(alone).individual_value(0);
}

LocalSearchSession::LocalSearchSession(SessionSetup setup) : setup_(std::move(setup)) {
  require(setup_.robot >= 0 && index(setup_.robot) < setup_.robots.size(),
          "local search: the robot must be one of the team");
  setup_.problem.candidates.resize(setup_.robots.size());
  const std::vector<Candidate>& own = setup_.problem.candidates[index(setup_.robot)];
  require(own.size() == setup_.own.size(), "local search: must have one motion per candidate");
  begin();
  for (std::size_t i = 0; i < own.size(); ++i) {
    const CandidateId id = oracle_->begin(setup_.robot) + static_cast<CandidateId>(i);
    setup_.own[i].robot = setup_.robots[index(setup_.robot)];
    setup_.own[i].energy_nats = own[i].energy_cost;
    setup_.own[i].information_nats =
        std::max(0.0, oracle_->individual_value(id) + own[i].energy_cost);
    own_.emplace(fingerprint(setup_.own[i]), i);
  }
  if (setup_.committed) {
    begin_from_committed(*setup_.committed);
  }
}

void LocalSearchSession::begin_from_committed(const std::vector<models::TeamChoice>& committed) {
  for (const models::TeamChoice& choice : committed) {
    const int robot = index_of(choice.robot);
    require(robot >= 0 && robot != setup_.robot,
            "local search: committed choices must belong to teammates");
  }
  models::TeamProposal& start = held_.emplace();
  start.stamp.time = setup_.activation;
  start.robot = setup_.robots[index(setup_.robot)];
  start.round = setup_.round;
  start.choices = committed;
  start.history = {fingerprint(setup_.robots, committed)};
  begin();
}

int LocalSearchSession::index_of(const std::string& robot) const {
  const auto found = std::find(setup_.robots.begin(), setup_.robots.end(), robot);
  return found == setup_.robots.end() ? -1 : static_cast<int>(found - setup_.robots.begin());
}

bool LocalSearchSession::belongs_to_round(const models::TeamProposal& received) const {
  return received.round == setup_.round && received.stamp.time == setup_.activation;
}

bool LocalSearchSession::is_consistent(const models::TeamProposal& received) const {
  if (index_of(received.robot) < 0 || received.history.empty() || !(received.value_nats > 0.0)) {
    return false;
  }
  for (const models::TeamChoice& choice : received.choices) {
    const int robot = index_of(choice.robot);
    if (robot < 0 || (robot == setup_.robot && own_.count(fingerprint(choice)) == 0)) {
      return false;
    }
  }
  return fingerprint(setup_.robots, received.choices) == received.history.back();
}

bool LocalSearchSession::receive(const models::TeamProposal& received) {
  if (!belongs_to_round(received) || !is_consistent(received)) {
    return false;
  }
  const auto rank = [this](const models::TeamProposal& proposal) {
    return std::tuple(-proposal.value_nats, index_of(proposal.robot), proposal.history.back());
  };
  if (held_ && !(rank(received) < rank(*held_))) {
    return false;
  }
  held_ = received;
  begin();
  return true;
}

const Candidate& LocalSearchSession::teammate_candidate(const models::TeamChoice& choice) {
  const ChoiceKey key(fingerprint(choice), choice.information_nats, choice.energy_nats);
  const auto known = teammate_candidates_.find(key);
  return known != teammate_candidates_.end()
             ? known->second
             : teammate_candidates_.emplace(key, setup_.candidate_of(choice)).first->second;
}

void LocalSearchSession::begin() {
  search_.reset();
  addition_.reset();
  team_.reset();
  for (std::size_t robot = 0; robot < setup_.robots.size(); ++robot) {
    if (robot != index(setup_.robot)) {
      setup_.problem.candidates[robot].clear();
    }
  }
  Choice choice(setup_.robots.size(), kNoCandidate);
  if (held_) {
    for (const models::TeamChoice& each : held_->choices) {
      const int robot = index_of(each.robot);
      if (robot != setup_.robot) {
        setup_.problem.candidates[index(robot)].push_back(teammate_candidate(each));
      }
    }
  }
  oracle_ = std::make_unique<TeamOracle>(setup_.problem);
  rule_ = std::make_unique<ImprovementRule>(*oracle_, kAlpha, kLeastRise_nats);
  if (held_) {
    for (const models::TeamChoice& each : held_->choices) {
      const int robot = index_of(each.robot);
      const auto at = robot == setup_.robot ? own_.at(fingerprint(each)) : 0;
      choice[index(robot)] = oracle_->begin(robot) + static_cast<CandidateId>(at);
    }
  }
  team_ = std::make_unique<TeamSet>(*oracle_);
  team_->become(choice);
  excluded_.assign(static_cast<std::size_t>(oracle_->candidate_count()), 0);
  addition_ = std::make_unique<BestAddition>(*oracle_, setup_.robot, oracle_->is_submodular());
  search_ =
      std::make_unique<ProposalSearch>(*oracle_, *rule_, setup_.robot, oracle_->is_submodular());
  search_->begin(choice, team_->value(), excluded_);
  phase_ = choice[index(setup_.robot)] == kNoCandidate ? Phase::kAdding : Phase::kSearching;
  if (held_ && held_->history.size() >= kHistoryMax) {
    phase_ = Phase::kDone;
  }
}

models::TeamProposal LocalSearchSession::solution_of(const Choice& choice) const {
  models::TeamProposal solution;
  solution.stamp.time = setup_.activation;
  solution.robot = setup_.robots[index(setup_.robot)];
  solution.round = setup_.round;
  for (int robot = 0; robot < static_cast<int>(setup_.robots.size()); ++robot) {
    const CandidateId id = choice[index(robot)];
    if (id != kNoCandidate) {
      solution.choices.push_back(robot == setup_.robot
                                     ? setup_.own[index(id - oracle_->begin(robot))]
                                     : *held_->find(setup_.robots[index(robot)]));
    }
  }
  if (held_) {
    solution.history = held_->history;
  }
  return solution;
}

bool LocalSearchSession::is_compatible(const models::TeamProposal& solution) const {
  const models::TeamChoice* own = solution.find(solution.robot);
  return own == nullptr || !setup_.keep_apart ||
         std::all_of(solution.choices.begin(), solution.choices.end(), [&](const auto& other) {
           return &other == own || setup_.keep_apart(*own, other);
         });
}

std::optional<models::TeamProposal> LocalSearchSession::try_proposal(const Proposal& found) {
  models::TeamProposal solution = solution_of(adopt(*oracle_, team_->choice(), found));
  const double before_nats = held_ ? held_->value_nats : 0.0;
  solution.value_nats = before_nats + (found.value - team_->value());
  const std::int64_t key = fingerprint(setup_.robots, solution.choices);
  const bool was_there =
      std::find(solution.history.begin(), solution.history.end(), key) != solution.history.end();
  if (!(solution.value_nats > before_nats) || was_there || !is_compatible(solution)) {
    return std::nullopt;
  }
  solution.history.push_back(key);
  return solution;
}

std::optional<models::TeamProposal> LocalSearchSession::improve(const Deadline& deadline) {
  std::int64_t done = 0;
  const auto calls = [this] { return team_->calls() + search_->calls(); };
  while (phase_ != Phase::kDone && !deadline.expired(done)) {
    const std::int64_t before = calls();
    std::optional<models::TeamProposal> proposal;
    if (phase_ == Phase::kAdding) {
      const Proposal best = addition_->find(*team_, excluded_);
      if (best.is_nothing() || !rule_->improves(team_->value(), best.value)) {
        phase_ = Phase::kSearching;  // the search excludes no candidate
        std::fill(excluded_.begin(), excluded_.end(), 0);
      } else {
        proposal = try_proposal(best);
        excluded_[index(best.add)] = 1;
      }
    } else {
      const ProposalSearch::State state = search_->advance();
      if (state == ProposalSearch::State::kNothing) {
        phase_ = Phase::kDone;
      } else if (state == ProposalSearch::State::kProposes) {
        proposal = try_proposal(search_->proposal());
      }
    }
    const std::int64_t spent = std::max<std::int64_t>(1, calls() - before);
    done += spent;
    calls_ += spent;
    if (proposal) {
      held_ = proposal;
      begin();
      return proposal;
    }
  }
  return std::nullopt;
}

}  // namespace vantage::planner
