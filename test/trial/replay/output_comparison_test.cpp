#include "trial/replay/output_comparison.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/logs/file_support.hpp"
#include "trial/replay/log_replay.hpp"

namespace vantage::trial {
namespace {

using logs::test::Bytes;
using logs::test::encoded;

vantage_lcm::plan_t plan_of(std::int64_t round) {
  vantage_lcm::plan_t plan{};
  plan.utime = 1'000'000 * round;
  plan.robot = "Q1";
  plan.round = round;
  plan.num_segments = 2;
  plan.segments.resize(2);
  plan.num_inputs = 2;
  plan.inputs.resize(2);
  plan.inputs[0].channel = "BELIEF_Q1";
  plan.inputs[0].run_id = 11;
  plan.inputs[0].sequence = 12;
  plan.inputs[1].channel = "PLAN_Q2";
  plan.inputs[1].run_id = 21;
  plan.inputs[1].sequence = 22;
  return plan;
}

// Changes one byte at a time: of the fingerprint, the time stamp, the publisher's identity (16
// bytes, which are ignored), and the rest.
TEST(OutputComparison, ComparesAllBytesExceptThePublisherIdentity) {
  vantage_lcm::mixture_t mixture{};
  mixture.utime = 7;
  mixture.robot = "Q1";
  mixture.step = 3;
  const Bytes logged = encoded(mixture);
  // Byte 31 is followed by the length of the name; the two letters of the name are bytes 36 and 37.
  for (std::size_t at = 8; at < 38; at += at == 31 ? 5 : 1) {
    Bytes replayed = logged;
    replayed[at] ^= 1U;
    OutputComparison comparison;
    comparison.add_logged(logged);
    comparison.add_replayed(replayed);
    EXPECT_EQ(comparison.different(), at >= 16 && at < 32 ? 0 : 1) << at;
    EXPECT_EQ(comparison.unexpected(), 0) << at;
  }
  OutputComparison comparison;
  comparison.add_logged(logged);
  mixture.robot = "Q12";
  comparison.add_replayed(encoded(mixture));
  EXPECT_EQ(comparison.different(), 1) << "the lengths differ";
}

TEST(OutputComparison, DistinguishesMessageTypesWithEqualIndex) {
  vantage_lcm::belief_t belief{};
  belief.step = 5;
  vantage_lcm::mixture_t mixture{};
  mixture.step = 5;
  const vantage_lcm::plan_t plan = plan_of(5);
  OutputComparison comparison;
  comparison.add_logged(encoded(belief));
  EXPECT_TRUE(comparison.has_logged(encoded(belief)));
  EXPECT_FALSE(comparison.has_logged(encoded(mixture)));
  EXPECT_FALSE(comparison.has_logged(encoded(plan)));
  comparison.add_logged(encoded(mixture));
  comparison.add_logged(encoded(plan));
  for (const Bytes& each : {encoded(plan), encoded(mixture), encoded(belief)}) {
    comparison.add_replayed(each);
  }
  EXPECT_EQ(comparison.logged(), 3);
  EXPECT_EQ(comparison.replayed(), 3);
  EXPECT_TRUE(comparison.is_exact());
  belief.step = 6;
  EXPECT_FALSE(comparison.has_logged(encoded(belief)));
  EXPECT_FALSE(comparison.has_logged(Bytes{1, 2, 3}));
}

// A local search makes several proposals per round; each is compared with the logged proposal of
// the same solution.
TEST(OutputComparison, ComparesProposalsOfTheSameSolution) {
  const auto proposal = [](std::int64_t before, std::int64_t last, double value_nat) {
    vantage_lcm::team_proposal_t out{};
    out.round = 4;
    out.num_history = 2;
    out.history = {before, last};
    out.value_nat = value_nat;
    return encoded(out);
  };
  OutputComparison comparison;
  comparison.add_logged(proposal(1, 10, 0.5));
  comparison.add_logged(proposal(1, 20, 0.75));
  comparison.add_replayed(proposal(1, 20, 0.75));
  comparison.add_replayed(proposal(1, 10, 0.5));
  EXPECT_TRUE(comparison.is_exact());
  comparison.add_replayed(proposal(10, 1, 0.5));
  EXPECT_EQ(comparison.unexpected(), 1);
  vantage_lcm::team_proposal_t first{};
  first.round = 4;
  EXPECT_FALSE(comparison.has_logged(encoded(first))) << "no solution is logged yet";
}

TEST(OutputComparison, ReportsTheDifferenceOfTheEarliestRound) {
  OutputComparison comparison;
  for (const int round : {3, 4, 5, 6}) {
    comparison.add_logged(encoded(plan_of(round)));
  }
  const auto replay = [&](int round, double height_m) {
    vantage_lcm::plan_t plan = plan_of(round);
    plan.height_m = height_m;
    plan.run_id = 99;
    plan.sequence = 98;
    plan.segments[1].speed_mps = 0.5;
    comparison.add_replayed(encoded(plan));
  };
  replay(5, 1.25);
  ASSERT_TRUE(comparison.first_difference());
  EXPECT_EQ(comparison.first_difference()->index, 5);
  replay(4, 2.5);
  replay(6, 3.75);
  replay(4, 4.75);
  EXPECT_EQ(comparison.different(), 4);
  EXPECT_EQ(comparison.unexpected(), 0);
  const OutputDifference& first = *comparison.first_difference();
  EXPECT_EQ(first.index, 4);
  EXPECT_EQ(first.time, from_utime(4'000'000));
  EXPECT_EQ(first.member, "height_m");
  EXPECT_EQ(first.logged, "0.0");
  EXPECT_EQ(first.replayed, "2.5");
  EXPECT_EQ(first.members_different, 2) << "and a speed; the publisher does not count";
  EXPECT_EQ(first.inputs, (std::vector<std::string>{"BELIEF_Q1 11/12", "PLAN_Q2 21/22"}));
}

TEST(OutputComparison, ReportsListsOfDifferentLengthAndBitDifferences) {
  OutputComparison comparison;
  comparison.add_logged(encoded(plan_of(1)));
  vantage_lcm::plan_t longer = plan_of(1);
  longer.num_segments = 3;
  longer.segments.resize(3);
  comparison.add_replayed(encoded(longer));
  ASSERT_TRUE(comparison.first_difference());
  EXPECT_EQ(comparison.first_difference()->member, "num_segments");
  EXPECT_EQ(comparison.first_difference()->members_different, 2)
      << "the number of items and the list";

  OutputComparison last;
  last.add_logged(encoded(plan_of(1)));
  vantage_lcm::plan_t other = plan_of(1);
  other.inputs[1].sequence += 1;  // changes the last byte
  last.add_replayed(encoded(other));
  ASSERT_TRUE(last.first_difference());
  EXPECT_EQ(last.first_difference()->member, "inputs[1].sequence");
  EXPECT_EQ(last.first_difference()->logged, "22");
  EXPECT_EQ(last.first_difference()->replayed, "23");

  OutputComparison bits;
  bits.add_logged(encoded(plan_of(1)));
  vantage_lcm::plan_t minus = plan_of(1);
  minus.start_x_world_m = -0.0;
  bits.add_replayed(encoded(minus));
  ASSERT_TRUE(bits.first_difference());
  EXPECT_EQ(bits.first_difference()->member, "(bits)");
  EXPECT_EQ(bits.first_difference()->members_different, 0);
}

TEST(OutputComparison, ComparesTheNewestOutputOfEachRound) {
  OutputComparison comparison;
  vantage_lcm::plan_t plan = plan_of(1);
  comparison.add_logged(encoded(plan));
  plan.height_m = 2.0;  // a restarted node publishes again
  comparison.add_logged(encoded(plan));
  comparison.add_replayed(encoded(plan));
  EXPECT_TRUE(comparison.is_exact());
  EXPECT_EQ(comparison.logged(), 2);
  comparison.add_replayed(Bytes{1});
  EXPECT_EQ(comparison.unreadable(), 1);
  EXPECT_FALSE(comparison.is_exact());
}

TEST(OutputComparison, IgnoresSignatures) {
  const auto judge = test::authenticator(test::keys_of_a_trial());
  Bytes signed_plan = encoded(plan_of(1));
  judge->seal("PLAN_Q1", "", from_utime(5), signed_plan);
  ASSERT_GT(signed_plan.size(), encoded(plan_of(1)).size());
  OutputComparison comparison;
  comparison.add_logged(signed_plan);
  EXPECT_TRUE(comparison.has_logged(encoded(plan_of(1))));
  EXPECT_TRUE(comparison.has_logged(signed_plan));
  comparison.add_replayed(encoded(plan_of(1)));
  comparison.add_replayed(signed_plan);
  EXPECT_TRUE(comparison.is_exact());
}

TEST(ReplayReport, CountsOutputsThatWereNotReproduced) {
  ReplayReport report;
  for (const int round : {1, 2, 3, 4, 5}) {
    report.outputs.add_logged(encoded(plan_of(round)));
  }
  for (const int round : {2, 4, 9}) {
    report.outputs.add_replayed(encoded(plan_of(round)));
  }
  EXPECT_EQ(report.not_replayed(), 3) << "outputs that the log lacks do not count";
}

TEST(DescribeDifference, StatesChannelTimeFieldAndValues) {
  OutputDifference difference;
  difference.index = 7;
  difference.time = from_utime(12'345);
  difference.member = "a.b[2]";
  difference.logged = "1.5";
  difference.replayed = "2.5";
  difference.members_different = 3;
  difference.inputs = {"X 1/2", "Y 3/4"};
  EXPECT_EQ(
      describe(difference),
      (std::vector<std::string>{"first difference: number 7, valid at 12345 µs, 3 fields differ",
                                "  a.b[2]", "    logged    1.5", "    replayed  2.5",
                                "  inputs of this output", "    X 1/2", "    Y 3/4"}));
}

}  // namespace
}  // namespace vantage::trial
