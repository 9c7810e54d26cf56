"""Ledger of drawn mutations and their outcomes: one JSON object per line, in the order of the draw."""

import collections
import json
import os
import pathlib
import random

from . import sites

# Outcomes of a mutation. Only the first three count in the score.
KILLED = "killed"  # noticed by a test (field `by`) that failed or exceeded the time limit
SURVIVED = "survived"
EQUIVALENT = "equivalent"  # with a `reason` that a person has written
SAME_CODE = "same code"  # the object code is unchanged
NOT_BUILT = "not built"  # does not compile
GONE = "gone"  # the source has changed and no longer contains the site
PENDING = "pending"
OUTCOMES = (KILLED, SURVIVED, EQUIVALENT, SAME_CODE, NOT_BUILT, GONE, PENDING)


class Ledger:
    """Rows of drawn mutations. A row is a dictionary with the keys id, draw, seed, file, line, operator, before,
    after, outcome; optionally by, reason, commit (of the outcome) and first (the first outcome, if it
    differs)."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.rows = []
        if self.path.exists():
            self.rows = [json.loads(line) for line in self.path.read_text().splitlines() if line.strip()]

    def save(self):
        """Writes the file atomically: a process killed here leaves the previous ledger."""
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
        """Adds the sites that no draw contains yet. Returns their number."""
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
    """Returns `count` random source files (.cpp); all files if `count` is None or not less than their number."""
    sources = sorted(name for name in names if name.endswith(".cpp"))
    if count is None or count >= len(sources):
        return names
    return sorted(random.Random(f"{seed}/{path}/files").sample(sources, count))


def draw(found, count, seed, name):
    """Draws `count` sites, with equal numbers per operator while each operator has sites left. The result
    depends only on the seed, the name and the set of sites, not on their order."""
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
    """Returns a table in Markdown with one row per value of the key, and one for all."""
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
        first[EQUIVALENT] = count[EQUIVALENT]  # mutations marked as equivalent later were also equivalent at first
        first[SURVIVED] -= sum(1 for row in group
                               if row["outcome"] == EQUIVALENT and row.get("first") == SURVIVED)
        idle = count[SAME_CODE] + count[NOT_BUILT] + count[GONE]
        lines.append(f"| {name} | {len(group)} | {count[KILLED]} | {count[SURVIVED]} | {count[EQUIVALENT]} | "
                     f"{_share(count)} | {_share(first)} | {idle} | {count[PENDING]} |")
    return "\n".join(lines)


def _share(count):
    """Returns (killed + equivalent) / (killed + equivalent + survived) mutations."""
    good = count[KILLED] + count[EQUIVALENT]
    whole = good + count[SURVIVED]
    return f"{100.0 * good / whole:.0f} %" if whole else "-"
