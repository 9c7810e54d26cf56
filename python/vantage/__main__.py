"""python3 -m vantage: shows an overview, or solves one planning problem."""
import argparse
import sys

import vantage


def listed(names):
    return "\n".join(f"  {name:26}{what}" for name, what in names.items())


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="python3 -m vantage", description=vantage.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=f"Searches:\n{listed(vantage.algorithms())}\n\nTeam decisions:\n{listed(vantage.team_algorithms())}"
        "\n\nMore: docs/guide/python.md, and the help of each class, such as help(vantage.Trial).")
    parser.add_argument("problem", nargs="?", help="JSON file of a planning problem; without it, this help is printed")
    parser.add_argument("--algorithm", default="default", help="search algorithm (default: chosen for the problem)")
    parser.add_argument("--nodes", type=int, help="node budget of the search (default: one second instead)")
    parser.add_argument("--version", action="version", version=f"vantage {vantage.__version__}")
    given = parser.parse_args(arguments)
    if given.problem is None:
        parser.print_help()
        return 0
    try:
        plan = vantage.plan(given.problem, algorithm=given.algorithm, nodes=given.nodes)
    except (vantage.StartupError, vantage.UsageError) as error:
        print(f"python3 -m vantage: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("python3 -m vantage: interrupted", file=sys.stderr)
        return 1
    print(plan)
    print(f"lower bound {plan.lower_bound}, controls {plan.controls.tolist()}")
    return 0 if plan.found else 1


if __name__ == "__main__":
    sys.exit(main())
