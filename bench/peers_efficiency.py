# SPDX-License-Identifier: Apache-2.0
"""The part of peers.py that compares noise and time. docs/performance.md defines the quantities."""
import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

import peers_grids

ROOT = Path(__file__).resolve().parents[1]
MITSUBA_SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
AUREOLE_SAMPLERS = ("sobol", "sobol, absolute", "sobol, display", "sobol, relative", "independent")
MEDIA = ("fog", "fog_chromatic", "milk", "smoke", "sparse_cloud")
MEDIA_INTEGRATORS = ("volpath", "volpathmis")
COLUMNS = ("program", "sampler", "spp", "seconds", "Msamples/s", "mean", "variance", "relRMSE", "efficiency",
           "by pixel")


@dataclass(frozen=True)
class Scene:
    name: str
    file: Path
    defines: tuple
    width: int
    height: int
    integrators: tuple = ("",)  # Mitsuba's, where the scene asks for one by the parameter of that name

    @property
    def title(self):
        return {"cbox": "cbox-spectral", "fog_chromatic": "chromatic fog", "milk": "milk behind rough glass",
                "sparse_cloud": "sparse cloud"}.get(self.name, self.name)


@dataclass(frozen=True)
class Contender:
    program: str  # "aureole", "eradiate", or Mitsuba's variant
    sampler: str  # aureole's may name the error that adaptive sampling makes small: "sobol, display"
    integrator: str = ""  # Mitsuba's

    @property
    def is_adaptive(self):
        return ", " in self.sampler

    @property
    def label(self):
        name = {"aureole": "aureole", "eradiate": "eradiate-mitsuba",
                "llvm_ad_spectral": "Mitsuba"}.get(self.program, "Mitsuba, scalar")
        return f"{name} {self.integrator}".rstrip()


def find_scenes(a, folder):
    """The scenes of Mitsuba that are there (says which are missing), and bench/scenes, with grids in a folder."""
    shared = Path(os.environ.get("AUREOLE_SHARED") or ROOT / ".." / "shared").resolve()
    h, w = a.height, (a.height * 683 + 256) // 512  # matpreview.xml is 683 x 512
    all_scenes = (Scene("cbox", shared / "data/mitsuba/scenes/cbox/cbox-spectral.xml", (("res", str(h)),), h, h),
                  Scene("matpreview", shared / "data/mitsuba/scenes/matpreview/matpreview.xml",
                        (("width", str(w)), ("height", str(h))), w, h))
    for s in all_scenes:
        if s.file.is_file():
            yield s
        elif s.name in a.only:
            print(f"{s.name}: skipped, there is no {s.file} (set AUREOLE_SHARED to the folder that holds "
                  "data/mitsuba/scenes)", file=sys.stderr)
    h = a.height * 3 // 8  # media need more samples
    for name in MEDIA:
        defines = (("width", str(h)), ("height", str(h)))
        if name in a.only and name in peers_grids.GRIDS:
            defines += (("grid", str(peers_grids.make(name, folder))),)
        yield Scene(name, ROOT / f"bench/scenes/{name}.xml", defines, h, h, MEDIA_INTEGRATORS)


def contenders(a, scene):
    peers = [("llvm_ad_spectral", s) for s in MITSUBA_SAMPLERS] + [("scalar_spectral", "independent")] * a.scalar
    return ([Contender("aureole", s) for s in AUREOLE_SAMPLERS] +
            [Contender(*peer, i) for i in scene.integrators for peer in peers] +
            [Contender("eradiate", "independent", "eovolpath")] * (a.eradiate is not None and scene.name in peers_grids.GRIDS))


def kind(scene, contender):
    return scene.name, contender


def size(scene, spp):
    return scene.width * scene.height * spp


def items(a, scene):
    return [(kind(scene, c), size(scene, spp)) for c in contenders(a, scene) for spp in a.spp for _ in range(a.replicates)]


class Mitsuba:
    """A process that keeps scenes and compiled kernels."""

    def __init__(self, python, variant, threads):
        command = [python, ROOT / "bench/peers_mitsuba.py", "serve", variant, str(threads)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def render(self, scene, contender, spp, seed, output):
        defines = dict(scene.defines) | ({"integrator": contender.integrator} if contender.integrator else {})
        request = {"file": str(scene.file), "defines": defines, "sampler": contender.sampler, "spp": spp,
                   "seed": seed, "output": str(output)}
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
            line = self.process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            sys.exit(f"Mitsuba ended unexpectedly ({scene.name}, {contender.sampler}, exit status {self.process.wait()})")
        reply = json.loads(line)
        if "error" in reply:
            sys.exit(f"Mitsuba, {scene.name}, {contender.sampler}:\n{reply['error']}")
        return reply["seconds"], reply["spp"]


def render_aureole(a, scene, sampler, spp, seed, output):
    picture = output.with_suffix(".exr")
    points, _, error = sampler.partition(", ")
    command = [a.aureole, "render", scene.file, "-o", picture, "--spp", str(spp), "--seed", str(seed), "--sampler",
               points, "--adaptive", error or "none", "--threads", str(a.threads), "--checkpoint", "1e9", "--restart",
               "--quiet"]
    for name, value in scene.defines:
        command += ["-D", f"{name}={value}"]
    r = subprocess.run(command, capture_output=True, text=True)
    if r.returncode != 0:
        sys.exit(f"aureole, {scene.name}, {sampler}: exit status {r.returncode}\n{r.stderr}")
    with OpenEXR.File(str(picture), separate_channels=True) as f:
        header, channels = f.header(), f.channels()
        rgb = np.stack([channels[c].pixels.astype(np.float32) for c in "RGB"], axis=-1)
        seconds, taken = float(header["aureole:seconds"]), int(header["aureole:spp"])
    np.save(output, rgb)
    return seconds, taken


@dataclass
class Result:
    contender: Contender
    spp: int
    seconds: list
    pictures: list

    def load(self):
        x = np.stack([np.load(p) for p in self.pictures]).astype(np.float64)
        if self.contender.program == "aureole" and not np.isfinite(x).all():
            sys.exit(f"{self.contender.label}, {self.contender.sampler}: the picture is not finite")
        return x


def variance(pictures, weight=1.0):
    """Unbiased variance between seeds, averaged over pixels and channels; its standard error by jackknife."""
    n = len(pictures)
    # Sums of squares about the mean of all, so that leaving one seed out needs no other pass.
    d = pictures - pictures.mean(axis=0)
    square = (d * d).sum(axis=0)
    value = float((weight * square).mean() / (n - 1))
    if n < 3:
        return value, float("nan")
    without = np.array([float((weight * (square - d[i] ** 2 * (n / (n - 1)))).mean() / (n - 2)) for i in range(n)])
    return value, float(np.sqrt((n - 1) / n * ((without - without.mean()) ** 2).sum()))


def render_all(a, scene, folder, progress):
    """Renders everything; programs and samplers take turns, so that a machine that slows down slows down all."""
    who = contenders(a, scene)
    results = {(c, spp): Result(c, 0, [], []) for spp in a.spp for c in who}
    servers = {}
    try:
        for seed in range(a.replicates):
            for spp in a.spp:
                for c in who[seed % len(who):] + who[:seed % len(who)]:
                    output = folder / f"{scene.name}-{c.program}-{c.integrator}-{c.sampler}-{spp}-{seed}.npy"
                    begin = time.perf_counter()
                    if c.program == "aureole":
                        seconds, taken = render_aureole(a, scene, c.sampler, spp, seed, output)
                    else:
                        if c.program not in servers:
                            python = a.eradiate if c.program == "eradiate" else sys.executable
                            servers[c.program] = Mitsuba(python, c.program, a.threads)
                        seconds, taken = servers[c.program].render(scene, c, spp, seed, output)
                    r = results[c, spp]
                    r.spp = taken
                    r.seconds.append(seconds)
                    r.pictures.append(output)
                    progress.step(kind(scene, c), size(scene, spp), time.perf_counter() - begin,
                                  f"{scene.name}, {spp} spp, {c.label} {c.sampler}, seed {seed}")
    finally:
        for s in servers.values():
            s.__exit__()
    return results


def run(a, scene, folder, progress, conditions):
    results = render_all(a, scene, folder, progress)
    rows, summary = [], []
    for spp in a.spp:
        group = [r for (_, asked), r in results.items() if asked == spp]
        table, text = compare(scene, spp, group)
        rows += table
        summary += text
    for r in results.values():
        for p in r.pictures:
            p.unlink()
    return "\n".join([f"### {scene.title}, {scene.width}x{scene.height}", "",
                      f"{a.replicates} seeds; {conditions}", "",
                      f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|", *rows, "", *summary]).rstrip()


def compare(scene, asked, group):
    """Rows of the table and sentences for one number of samples."""
    all_means = {r.contender: r.load().mean(axis=0) for r in group}
    middle = np.nanmedian([m.mean() for m in all_means.values()])
    # Some of Mitsuba's samplers give pixels of 1e6 and more in media now and then, or none that is a number.
    means = {c: m for c, m in all_means.items() if abs(m.mean() - middle) < middle / 2}
    broken = ", ".join(f"{c.label} {c.sampler}" for c in all_means if c not in means)
    group = [r for r in group if np.isfinite(all_means[r.contender]).all()]
    reference = np.mean(list(means.values()), axis=0)
    weight = 1 / (reference**2 + 0.01 * reference.mean() ** 2)
    rows, score, noise = [], {}, {}
    for r in group:
        x = r.load()
        seconds, mean = min(r.seconds), x.mean()
        v, v_error = variance(x)
        relative, relative_error = variance(x, weight)
        noise[r.contender] = relative / len(x)
        score[r.contender] = [(mean**2 / (v * seconds), v_error / v),
                              (1 / (relative * seconds), relative_error / relative)]
        rate = scene.width * scene.height * r.spp / seconds * 1e-6
        cells = [r.contender.label, r.contender.sampler, r.spp, f"{seconds:.3f}", f"{rate:.2f}", f"{mean:.5g}",
                 f"{v:.3g}", f"{relative**0.5:.4f}", *(with_error(*s) for s in score[r.contender])]
        rows.append(f"| {' | '.join(map(str, cells))} |")
        # Other work on the machine, or a clock that changes: the least of the times may still be too long.
        if np.median(r.seconds) > 1.1 * seconds:
            print(f"note: times of {r.contender.label} {r.contender.sampler}, {asked} spp, differ: least "
                  f"{seconds:.3f} s, median {np.median(r.seconds):.3f} s", file=sys.stderr)
    outliers = [f"- {asked} spp, left out of the agreement for pixels without bounds: {broken}"] if broken else []
    return rows, [ratios(asked, score, 0, "efficiency"), ratios(asked, score, 1, "by pixel"),
                  same_picture(scene, asked, means, noise, weight), *outliers, ""]


def with_error(value, relative_error):
    return f"{value:.4g}" if np.isnan(relative_error) else f"{value:.4g} ± {100 * relative_error:.1f} %"


def ratios(asked, score, which, name):
    best = max((c for c in score if c.program not in ("aureole", "eradiate")), key=lambda c: score[c][which][0])
    text = []
    for c in score:
        if c.program == "aureole":
            (mine, my_error), (other, other_error) = score[c][which], score[best][which]
            text.append(f"{c.sampler} {with_error(mine / other, float(np.hypot(my_error, other_error)))}")
    other = f"{best.label.removeprefix('Mitsuba').strip(', ')} {best.sampler}".strip()
    return f"- {asked} spp, {name}: aureole / best of Mitsuba ({other}): **{', '.join(text)}**"


def same_picture(scene, asked, means, noise, weight):
    """The programs' mean pictures must agree: the RMS difference beyond that of the noise, relative as in relRMSE.

    Without adaptive ones, whose random numbers are those of the sampler's own pictures, and without eradiate-mitsuba."""
    pooled, square = [], 0.0
    for mine in (True, False):
        own = [c for c in means if (c.program == "aureole") == mine and c.program != "eradiate" and not c.is_adaptive]
        pooled.append(np.mean([means[c] for c in own], axis=0))
        square += sum(noise[c] for c in own) / len(own) ** 2
    beyond = np.sqrt(max(0.0, (weight * (pooled[0] - pooled[1]) ** 2).mean() - square))
    difference = (pooled[0].mean() - pooled[1].mean()) / np.mean(pooled)
    noise_rms = np.sqrt(square)
    if beyond > 0.05 + 0.5 * noise_rms or abs(difference) > 0.02 + 0.5 * noise_rms:
        print(f"WARNING: {scene.name}: the programs' pictures differ, so their noise cannot be compared",
              file=sys.stderr)
    return (f"- {asked} spp, agreement: the means of the pictures differ by {100 * difference:+.2f} %, the pixels by "
            f"{100 * beyond:.2f} % (RMS beyond the noise of {100 * noise_rms:.2f} %)")
