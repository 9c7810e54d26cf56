"""What was drawn and what came of it: one JSON object a line, in the order of the draw."""

import collections
import json
import os
import pathlib
import random

from . import sites

# What a mutation can have come to. Of the score are the first three.
KILLED = "killed"  # `by` a test that failed, or by the time limit
SURVIVED = "survived"
EQUIVALENT = "equivalent"  # with a `reason` that a person wrote
SAME_CODE = "same code"  # the compiler makes the same bytes of it
NOT_BUILT = "not built"  # does not compile
GONE = "gone"  # the source has changed, and no longer has it
PENDING = "pending"
OUTCOMES = (KILLED, SURVIVED, EQUIVALENT, SAME_CODE, NOT_BUILT, GONE, PENDING)


class Ledger:
    """Rows are dictionaries: id, draw, seed, file, line, operator, before, after, outcome; then by,
    reason, commit (at which it came to that) and first (what it had come to at first, if that was
    something else)."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.rows = []
        if self.path.exists():
            self.rows = [json.loads(line) for line in self.path.read_text().splitlines() if line.strip()]

    def save(self):
        """All or nothing: whoever is killed here leaves the ledger of before."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = self.path.with_suffix(".unfinished")
        with open(unfinished, "w", encoding="utf-8") as file:
            for row in self.rows:
                file.write(json.dumps(row, ensure_ascii=False) + "\n")
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, self.path)

    def find(self, id_):
        return next((row for row in self.rows if row["id"] == id_), None)

    def has_draw(self, name, seed):
        return any(row["draw"] == name and row["seed"] == seed for row in self.rows)

    def add(self, drawn, name, seed):
        """Adds what is not there yet, of whichever draw; returns how much that was."""
        known = {row["id"] for row in self.rows}
        fresh = [site for site in drawn if site.id not in known]
        for site in fresh:
            self.rows.append({"id": site.id, "draw": name, "seed": seed, "file": site.file,
                              "line": site.line, "operator": site.operator, "before": site.before,
                              "after": site.after, "outcome": PENDING})
        return len(fresh)

    def settle(self, row, outcome, commit="", by="", reason=""):
        if row["outcome"] not in (PENDING, outcome) and "first" not in row:
            row["first"] = row["outcome"]
        row["outcome"] = outcome
        for key, value in (("by", by), ("reason", reason), ("commit", commit)):
            row.pop(key, None)
            if value:
                row[key] = value


def some_files(names, count, seed, path):
    """`count` of the source files, or all files: where there is no time to read a whole folder."""
    sources = sorted(name for name in names if name.endswith(".cpp"))
    if count is None or count >= len(sources):
        return names
    return sorted(random.Random(f"{seed}/{path}/files").sample(sources, count))


def draw(found, count, seed, name):
    """`count` of the sites, each kind of bug as often as the others while it lasts; of one seed and name
    always the same from the same sites, in whatever order they come."""
    chance = random.Random(f"{seed}/{name}")
    by_operator = collections.defaultdict(list)
    for site in sorted(found, key=lambda site: (site.file, site.begin, site.end, site.id)):
        by_operator[site.operator].append(site)
    for pool in by_operator.values():
        chance.shuffle(pool)
    drawn = []
    while len(drawn) < count and by_operator:
        kinds = [kind for kind in sites.OPERATORS if by_operator.get(kind)]
        if not kinds:
            break
        chance.shuffle(kinds)
        for kind in kinds[:count - len(drawn)]:
            drawn.append(by_operator[kind].pop())
    return drawn


def table(rows, key):
    """Markdown: a line for each value of the key, then all."""
    groups = collections.OrderedDict()
    for row in rows:
        groups.setdefault(str(row[key]), []).append(row)
    if len(groups) > 1:
        groups["**all**"] = list(rows)
    lines = [f"| {key} | drawn | killed | survived | equivalent | noticed | noticed at first | not counted | pending |",
             "|---|---|---|---|---|---|---|---|---|"]
    for name, group in groups.items():
        count = collections.Counter(row["outcome"] for row in group)
        first = collections.Counter(row.get("first", row["outcome"]) for row in group)
        first[EQUIVALENT] = count[EQUIVALENT]  # was so from the beginning
        first[SURVIVED] -= sum(1 for row in group
                               if row["outcome"] == EQUIVALENT and row.get("first") == SURVIVED)
        idle = count[SAME_CODE] + count[NOT_BUILT] + count[GONE]
        lines.append(f"| {name} | {len(group)} | {count[KILLED]} | {count[SURVIVED]} | {count[EQUIVALENT]} | "
                     f"{_share(count)} | {_share(first)} | {idle} | {count[PENDING]} |")
    return "\n".join(lines)


def _share(count):
    """Killed or equivalent, of all that could be noticed."""
    good = count[KILLED] + count[EQUIVALENT]
    whole = good + count[SURVIVED]
    return f"{100.0 * good / whole:.0f} %" if whole else "-"
