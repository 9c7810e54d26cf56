#!/usr/bin/env bash
# planner_words.sh VANTAGE SCENARIO: checks that --planner accepts every value of planner.algorithm,
# and flies one trial with each search algorithm.
source "$(dirname "$0")/begin.sh"
scenario=$2

sed 's/^  algorithm: [a-z_]*/  algorithm: nothing/' "$scenario" > "$work/nothing.yaml"
"$vantage" check "$work/nothing.yaml" > "$work/refused" 2>&1 && fail "algorithm: nothing"
words=$(sed -n 's/.*algorithm: must be one of \(.*\); is .*/\1/p' "$work/refused")
[[ "$words" == *" astar"* ]] || fail "the algorithms of the scenario reader are '$words'"
for word in ${words//,/}; do
  if [[ $word == external ]]; then
    # The value `external` is accepted, but an external planner needs real time.
    said=$("$vantage" trial "$scenario" --planner external --duration-s 1 2>&1) && fail "external"
    [[ "$said" == *"requires a planner process on the bus"* ]] || fail "external: $said"
  else
    "$vantage" trial "$scenario" --planner "$word" --nodes 100 --duration-s 3 --json > "$work/$word.json" ||
      fail "--planner $word"
  fi
done
for command in demo up; do
  "$vantage" "$command" --help | tr -d ' \n' | grep -qF "{${words// /}}" || fail "$command offers other algorithms than the scenario reader"
done
echo "planner_words: ${words}"
