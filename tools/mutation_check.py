#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts one wrong weight, pdf or random number at a time into the transport code, and checks that the tests notice each.

    tools/mutation_check.py FOLDER [--only NAME ...]     # FOLDER receives a checkout of HEAD and its build; it is kept for the next run

Each mutant is an edit of one place in a source: its old text must stand there exactly once, else the list below is out of date and the
exit status is 2. A mutant that compiles and fails no test survives: its name is printed, and the exit status is 1. A run of all mutants
takes about a minute and a half each on two cores.
"""
import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE = "src/aureole/"
# Tests of transport that take seconds. A mutant that all of them pass is tried on the reference pictures.
FAST = ("PathOracle*:*MatrixLightWalks*:Weight.*:PathDensity.*:TwoWayWeights.*:*LockStep*:Emerge*:Equiangular*:NullSurface*:"
        "*TwoWay*:*Furnace*:*ClosedRoom*:Emission*")
REFERENCES = "*References*path*:*References*medium*:*References*ptracer*:*References*direct*:Slab*:*LightTracing*"
MUTANTS = {  # name: (file, old, new)
    "light ratio without its pdf": ("spectrum/path_density.h", "r_l = delta ? Spectrum(0.f) : r_u * inverse;", "r_l = delta ? Spectrum(0.f) : r_u;"),
    "hit lights ignore light sampling": ("spectrum/path_density.h", "(w.pdf * sum(r_u + r_l * light_pdf))", "(w.pdf * sum(r_u))"),
    "wavelengths count equally": ("spectrum/path_density.h", "return seen(radiance) / (w.pdf * sum(r_u));",
                                  "return seen(radiance) / (w.pdf * float(kWavelengths));"),
    "wavelengths of light paths count equally": ("spectrum/path_density.h", "return L::measured(f.of(beta)) * importance / (w.pdf * sum(r_u));",
                                  "return L::measured(f.of(beta)) * importance / (w.pdf * float(kWavelengths));"),
    "media swap the ratios": ("spectrum/path_density.h", "    r_u *= p.flight;\n    r_l *= p.connection;", "    r_u *= p.connection;\n    r_l *= p.flight;"),
    "products in the wrong order": ("spectrum/path_density.h", "beta = beta.after(f);", "beta = f.after(beta);"),
    "connections ignore other techniques": ("transport/connection.h", "passage = Spectrum(1.f) / (w.pdf * sum(own_pdf + other_pdf));",
                                            "passage = Spectrum(1.f) / (w.pdf * sum(own_pdf));"),
    "other techniques pass media for nothing": ("transport/connection.h", "(others_pass ? other : other * walked)", "other"),
    "no probability of the light": ("transport/next_event.h", "(choice.probability * direct.pdf * counts.light);", "(direct.pdf * counts.light);"),
    "points are found by scattering": ("transport/next_event.h", "other = direct.delta ? Spectrum(0.f) : path.r_u * response.pdf * counts.scatter;",
                                       "other = path.r_u * response.pdf * counts.scatter;"),
    "light paths of one wavelength": ("integrator/ptracer/particle_walk.h", "own = s.density.r_u, other = 0.f;", "own = Spectrum(1.f), other = 0.f;"),
    "recursion forgets a technique": ("transport/two_way.h", "s.delta ? reverse * earlier : reverse * earlier + this->r_l;", "reverse * earlier;"),
    "recursion without the distance": ("transport/two_way.h", "this->r_l *= spread * inverse;", "this->r_l *= inverse;"),
    "no cosine at a light that was hit": ("integrator/bdpt/sensor_walk.h", "(emission_density(scene_, light, part, point, -d, wavelengths(i).time) * safe_inverse(cosine))",
                                          "emission_density(scene_, light, part, point, -d, wavelengths(i).time)"),
    "no distance to a point light": ("integrator/bdpt/sensor_walk.h", "emission *= safe_inverse(length_squared(direct.p - vertex.p()));", "(void)0;"),
    "pdf of the wrong end": ("integrator/bdpt/sensor_walk.h", "end.density.r_u * there.pdf", "end.density.r_u * here.pdf"),
    "roulette without compensation": ("transport/walk.h", "    s.density.survive(survival);\n", ""),
    "no correction for shading normals": ("transport/vertex.h", "return below > 0 ? std::abs(wi_.z * dot(point_.ng, d)) / below : 0.f;", "return below > 0 ? 1.f : 0.f;"),
    "lobe and roulette share a number": ("transport/dimensions.h", "lobe = 1,", "lobe = 2,"),
    "distance and roulette share a number": ("transport/dimensions.h", "distance = 3", "distance = 2"),
    "uniform media as if connected for certain": ("transport/medium_segment.cpp", "  passage.connection = inverse;\n  passage.value = relative", "  passage.connection = 1.f;\n  passage.value = relative"),
    "equiangular positions without a pdf": ("transport/equiangular_connection.h", "path.r_u * positions.pdf(t)", "path.r_u"),
    "exits without their choice": ("transport/emerge.h", "  density.survive(e.chosen);\n", ""),
    "importance as radiance": ("transport/vertex.h", "return L::lift(value * correction(d), point_.p, -to_previous_, d);", "return L::lift(value * correction(d), point_.p, -d, to_previous_);"),
}


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", type=Path)
    p.add_argument("--only", nargs="+", default=[""], help="mutants that have one of these in their names")
    p.add_argument("--jobs", default=str(os.cpu_count()))
    a = p.parse_args()
    tree = a.folder.resolve() / "tree"
    head = run("git", "-C", ROOT, "rev-parse", "HEAD").stdout.strip()
    if not tree.exists():
        tree.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(["git", "clone", "-q", ROOT, tree], check=True)
    subprocess.run(["git", "-C", tree, "fetch", "-q", ROOT, head], check=True)
    subprocess.run(["git", "-C", tree, "checkout", "-qf", head], check=True)
    stale = [name for name, (file, old, _) in MUTANTS.items() if (tree / SOURCE / file).read_text().count(old) != 1]
    if stale:
        print("not found once in their sources: " + ", ".join(stale), file=sys.stderr)
        sys.exit(2)
    subprocess.run(["cmake", "--preset", "release", "-DAUREOLE_PYTHON=OFF"], cwd=tree, check=True, stdout=subprocess.DEVNULL)
    build = ["cmake", "--build", "--preset", "release", "-j", a.jobs, "--target", "aureole_tests"]
    tests = tree / "build/release/bin/aureole_tests"

    def caught():
        """Which tests fail, or "" where none does."""
        made = run(*build, cwd=tree)
        if made.returncode != 0:
            return "the compiler"
        for tests_to_run in (FAST, REFERENCES):
            result = run(tests, f"--gtest_filter={tests_to_run}", "--gtest_brief=1", cwd=tree / "build/release")
            failed = [line.split("]", 1)[1].split(",")[0].strip() for line in result.stdout.splitlines() if line.startswith("[  FAILED  ]")]
            if result.returncode != 0:
                return failed[0] if failed else f"exit status {result.returncode}"
        return ""

    if problem := caught():
        print(f"without a mutant {problem} fails", file=sys.stderr)
        sys.exit(2)
    survivors = []
    for name, (file, old, new) in MUTANTS.items():
        if not any(part in name for part in a.only):
            continue
        source = tree / SOURCE / file
        text = source.read_text()
        source.write_text(text.replace(old, new))
        by = caught()
        source.write_text(text)
        print(f"{name:45} {'caught by ' + by if by else 'SURVIVES'}", flush=True)
        if not by:
            survivors.append(name)
    print(f"{len(survivors)} survive" + "".join("\n  " + s for s in survivors))
    sys.exit(1 if survivors else 0)


if __name__ == "__main__":
    main()
