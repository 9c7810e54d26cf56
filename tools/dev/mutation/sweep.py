"""Builds all mutations of a file into one object, so that the file is compiled once instead of once per mutation.
Each function contains one copy of its body per mutation; a number from the environment selects the copy."""

import bisect
import collections
import os
import re
import shutil

from . import ledger, sites
from .workshop import UserError

VARIABLE = "VANTAGE_MUTANT"  # environment variable with the number; without it the original code runs
CHOICE = "vantage_mutant"  # variable of the program with the same number
OPTIONS = ("-w", "-D_GLIBCXX_ASSERTIONS")  # assertions detect an index out of range
# Runs before all other constructors of the program, because these register tests and create the inputs of tests.
CHOOSER = f"""#include <cstdlib>
extern "C" int {CHOICE} = -1;
__attribute__((constructor(101))) static void choose() {{
  if (const char* number = std::getenv("{VARIABLE}")) {CHOICE} = std::atoi(number);
}}
"""


def text_of(source, bodies, numbered):
    """Returns the source with one copy of a function's body per mutation, and the owners of its lines: a list of (first
    line, number of the mutation or None) in order. `numbered`: list of (number, site)."""
    pieces = [f'extern "C" int {CHOICE};\n'.encode()]
    owners = [(1, None)]
    line = 2

    def write(piece):
        nonlocal line
        pieces.append(piece)
        line += piece.count(b"\n")

    inside = collections.defaultdict(list)
    for number, site in numbered:
        inside[body_of(bodies, site)].append((number, site))
    at = 0
    for body in bodies:
        if not inside[body]:
            continue
        write(source[at:body.begin])
        for number, site in inside[body]:
            write(b"\n")
            owners.append((line, number))
            write(f"if ({CHOICE} == {number}) {{\n".encode())
            write(site.apply(source)[body.begin:body.end + len(site.replacement) - (site.end - site.begin)])
            write(b"\nreturn;}\n" if body.is_void else b"\n}\n")
            owners.append((line, None))
        at = body.begin
    write(source[at:])
    return b"".join(pieces), owners


def body_of(bodies, site):
    """Returns the function body that contains a site; None if there is none."""
    return next((body for body in bodies if body.begin <= site.begin and site.end <= body.end), None)


def culprits(errors, owners):
    """Returns the numbers of the mutations in lines with compile errors."""
    lines = [line for line, _ in owners]
    found = {owners[bisect.bisect_right(lines, line) - 1][1] for line in errors}
    return found - {None}


class Sweep:
    """Test programs of some files, each linked with all mutations of these files."""

    def __init__(self, shop, sites_of):
        """Compiles all mutations. `sites_of` contains the sites of each file."""
        self.shop = shop
        self.place = shop.place / "sweep"
        shutil.rmtree(self.place, ignore_errors=True)
        self.place.mkdir()
        self.number_of = {}  # number of each built mutation, by id
        self.errors = {}  # error of each mutation that was not built, by id
        self.outside = []  # sites outside of functions
        self.objects = {}  # object with all mutations, by object of the build
        self.paths = {}  # path of each linked program, by program
        number = 0
        for name, found in sites_of.items():
            bodies = sites.find_bodies(shop.root / name, name, shop.arguments_for(name))
            numbered = []
            for site in found:
                if body_of(bodies, site) is None:
                    self.outside.append(site)
                else:
                    numbered.append((number, site))
                    number += 1
            self.compile(name, bodies, numbered)
        chooser = self.place / "chooser.cpp"
        chooser.write_text(CHOOSER)
        self.objects["chooser"] = chooser.with_suffix(".o")
        shop.command([next(iter(shop.command_of.values()))[0], "-c", chooser, "-o", self.objects["chooser"]])

    def compile(self, name, bodies, numbered):
        """Compiles each object of a file, without the mutations that do not compile."""
        source = (self.shop.root / name).read_bytes()
        wanted = sorted({o for _, objects in self.shop.programs_for(name) for o in objects
                         if self.shop.source_of[o] == name})
        left = list(numbered)
        for each in wanted:
            made = self.place / f"{len(self.objects)}.o"
            while True:
                text, owners = text_of(source, bodies, left)
                output, code = self.shop.compile(each, made, self.place / "sources", name, text, OPTIONS)
                if code == 0:
                    break
                where = re.findall(rf"sources/{re.escape(name)}:(\d+):(?:\d+:)?\s+(?:error:|  required)", output)
                bad = culprits(map(int, where), owners)
                if not bad:
                    raise UserError(f"{name}: {output[-2000:]}")
                self.errors |= {site.id: "does not compile" for number, site in left if number in bad}
                left = [(number, site) for number, site in left if number not in bad]
            self.objects[each] = made
        self.number_of |= {site.id: number for number, site in left}
        self.shop.say(f"{name}: {len(left)} of {len(numbered)} in one object")

    def judge(self, site, killers=()):
        """Returns the outcome, and the test that noticed the mutation or the programs that did not notice it."""
        if site.id in self.errors:
            return ledger.NOT_BUILT, self.errors[site.id]
        chosen = ("env", f"{VARIABLE}={self.number_of[site.id]}")
        tried = []
        for program, _ in self.shop.programs_for(site.file):
            known = self.shop.known(program)
            if not known:
                continue
            path = self.path_of(program)
            tried.append(path.name)
            killer = self.shop.killer(program, path, [test.run_by(chosen) for test in known], killers)
            if killer:
                return ledger.KILLED, killer
        return (ledger.PENDING, "") if self.shop.quick_s is not None else (ledger.SURVIVED, " ".join(tried))

    def path_of(self, program):
        """Returns the path of the program with all mutations. Links this program at the first call."""
        with self.shop.mutex:
            if program not in self.paths:
                path = self.place / os.path.basename(program)
                mine = {o: made for o, made in self.objects.items()
                        if o in self.shop.programs[program] or o == "chooser"}
                output, code = self.shop.link(program, mine, path)
                if code != 0:
                    raise UserError(f"{program}: {output[-2000:]}")
                self.paths[program] = path
            return self.paths[program]
