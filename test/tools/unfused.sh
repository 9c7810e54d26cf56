#!/bin/bash
# unfused.sh PROGRAM…: checks that no program computes a product and a sum with one rounding
# (docs/decisions/0014). Compilers do this at some levels of optimisation unless they are prevented.
set -euo pipefail
status=0
for program in "$@"; do
  if objdump --disassemble --demangle --no-show-raw-insn "$program" |
    awk '/^[0-9a-f]+ <.*>:$/ { where = $0 }
         /\t(vfn?m(add|sub)|fn?m(add|sub)|fml[as])/ { if (where != said) { print where; said = where } print; found = 1 }
         END { exit !found }'; then
    echo "$program has fused products" >&2
    status=1
  fi
done
exit $status
