#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pictures of Gaussian splats beside those of other programs, in a Python with their packages.

    python3 -m venv venv && venv/bin/pip install numpy OpenEXR mitsuba==3.9.1 torch
    venv/bin/pip download --no-deps gsplat==1.5.3 && unzip gsplat-*.whl gsplat/cuda/_torch_impl.py
    venv/bin/python bench/peers_splats.py gsplat --formulas gsplat/cuda/_torch_impl.py
    venv/bin/python bench/peers_splats.py mitsuba

gsplat: gsplat's plain formulas in torch (projection, harmonics, weights; the sum over the sorted splats of a pixel is a loop here,
where gsplat calls a CUDA kernel), for splats one by one and for a picture of many. Prints the largest difference of a splat's opacity
times colour, and the mean and the largest difference of the picture.

mitsuba: the integrator volprim_rf_basic, which traces rays through ellipsoids, for a cloud of small splats. Prints the difference of
the pictures and the time of a frame of both, each on --threads threads: of Mitsuba a frame after its kernels are compiled, of aureole
the whole program, which also reads the file and writes the picture. CPU times count the work on a machine that others use; a frame
without the file is what `aureole_bench --benchmark_filter=splat_frame` measures."""
import argparse
import importlib.util
import pathlib
import re
import resource
import subprocess
import tempfile
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


def cloud(count, seed, scale, degree=3, depth=(2, 8), opacity=(0.02, 0.98)):
    """Random splats before a camera at the origin that looks along +z, with y down (RDF)."""
    r = np.random.default_rng(seed)
    z = r.uniform(*depth, count)
    means = np.stack([r.uniform(-0.45, 0.45, count) * z, r.uniform(-0.25, 0.25, count) * z, z], axis=1)
    terms = (degree + 1) ** 2
    sh = r.normal(0, 0.15, (count, terms, 3))
    sh[:, 0] = r.uniform(-1.2, 1.2, (count, 3))
    quats = r.normal(size=(count, 4))
    return dict(means=means, scales=scale * z[:, None] * np.exp(r.normal(0, 0.6, (count, 3))),
                quats=quats / np.linalg.norm(quats, axis=1, keepdims=True), opacities=r.uniform(*opacity, count), sh=sh)


def write_ply(path, c):
    rest = c["sh"].shape[1] - 1
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"] + [f"f_rest_{k}" for k in range(3 * rest)]
    names += ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    n = len(c["means"])
    columns = [c["means"], c["sh"][:, 0], c["sh"][:, 1:].transpose(0, 2, 1).reshape(n, -1),
               np.log(c["opacities"] / (1 - c["opacities"]))[:, None], np.log(c["scales"]), c["quats"]]
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {n}\n" + "".join(f"property float {x}\n" for x in names)
    path.write_bytes((head + "end_header\n").encode() + np.concatenate(columns, axis=1).astype("<f4").tobytes())


def as_float(c):
    return {k: v.astype(np.float32).astype(np.float64) for k, v in c.items()}


def cpu_of_children():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


class Aureole:
    def __init__(self, binary, threads, folder):
        self.binary, self.threads, self.folder = binary, threads, pathlib.Path(folder)

    def render(self, c, width, height, focal, settings=""):
        """The channels splats.R, splats.G, splats.B and transmittance, and the seconds of rendering and of all."""
        import OpenEXR
        write_ply(self.folder / "cloud.ply", c)
        fov = 2 * np.degrees(np.arctan(0.5 * width / focal))
        (self.folder / "scene.xml").write_text(f"""<scene version="3.0.0">
<integrator type="splat"><boolean name="measures" value="true"/><string name="background" value="0, 0, 0"/>{settings}</integrator>
<sensor type="perspective"><float name="fov" value="{fov:.17g}"/><string name="fov_axis" value="x"/>
<transform name="to_world"><lookat origin="0, 0, 0" target="0, 0, 1" up="0, -1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/><rfilter type="box"/>
<string name="component_format" value="float32"/></film>
<sampler type="sobol"><integer name="sample_count" value="1"/></sampler></sensor>
<shape type="cube"><transform name="to_world"><scale value="50"/></transform><bsdf type="null"/>
<medium type="splats" name="interior"><string name="filename" value="cloud.ply"/><string name="file_axes" value="RUB"/></medium>
</shape></scene>""")
        begin, cpu = time.perf_counter(), cpu_of_children()
        out = subprocess.run([self.binary, "render", "scene.xml", "-o", "out.exr", "--threads", str(self.threads)],
                             cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True).stdout
        whole = time.perf_counter() - begin
        self.cpu = cpu_of_children() - cpu
        seconds = float(re.search(r"in ([0-9.]+) s", out).group(1))
        with OpenEXR.File(str(self.folder / "out.exr"), separate_channels=True) as f:
            channels = f.channels()
            picture = np.stack([channels[k].pixels for k in ("splats.R", "splats.G", "splats.B", "transmittance")], axis=2)
        return picture.astype(np.float64), seconds, whole


def gsplat_picture(formulas, c, width, height, focal, only=None):
    """The weighted colours and the transmittance at the centres of pixels, in double precision."""
    import torch
    t = {k: torch.tensor(v, dtype=torch.float64) for k, v in c.items()}
    k = torch.tensor([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]], dtype=torch.float64)
    covars, _ = formulas._quat_scale_to_covar_preci(t["quats"], t["scales"], compute_preci=False)
    radii, means, depths, conics, _ = formulas._fully_fused_projection(t["means"], covars, torch.eye(4, dtype=torch.float64)[None], k[None],
                                                                       width, height)
    degree = int(round(t["sh"].shape[1] ** 0.5)) - 1
    colors = torch.clamp_min(formulas._spherical_harmonics(degree, t["means"], t["sh"]) + 0.5, 0.0).numpy()
    means, conics, depths, seen = means[0].numpy(), conics[0].numpy(), depths[0].numpy(), (radii[0] > 0).all(dim=-1).numpy()
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    picture, passed, done = np.zeros((height, width, 3)), np.ones((height, width)), np.zeros((height, width), bool)
    for i in np.argsort(depths, kind="stable"):
        if not seen[i]:
            continue
        dx, dy = x - means[i, 0], y - means[i, 1]
        sigma = 0.5 * (conics[i, 0] * dx * dx + conics[i, 2] * dy * dy) + conics[i, 1] * dx * dy
        alpha = np.minimum(0.999, c["opacities"][i] * np.exp(-sigma))
        alpha = np.where((sigma >= 0) & (alpha >= 1 / 255) & ~done, alpha, 0)
        left = passed * (1 - alpha)
        done |= (alpha > 0) & (left <= 1e-4)
        alpha = np.where(done, 0, alpha)
        picture += (passed * alpha)[..., None] * colors[i]
        passed = passed * (1 - alpha)
    return np.concatenate([picture, passed[..., None]], axis=2)


SAME_AS_GSPLAT = """<float name="opacity_cap" value="0.999"/><float name="near" value="0.01"/><float name="cutoff" value="20"/>"""


def compare_gsplat(a, aureole):
    spec = importlib.util.spec_from_file_location("torch_impl", a.formulas)
    formulas = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(formulas)
    width, height, focal = 96, 64, 90.0
    most, at_limit = 0, 0
    for i in range(a.single):
        c = as_float(cloud(1, 100 + i, 0.06))
        ours, theirs = aureole.render(c, width, height, focal, SAME_AS_GSPLAT)[0], gsplat_picture(formulas, c, width, height, focal)
        # A pixel at the threshold of 1/255 may fall to either side of it.
        edge = ((ours[..., 3] == 1) != (theirs[..., 3] == 1)) & (np.minimum(ours[..., 3], theirs[..., 3]) > 1 - 1.01 / 255)
        at_limit += edge.sum()
        most = max(most, np.abs(ours - theirs)[~edge].max())
    print(f"gsplat: {a.single} splats one by one at {width} x {height}: largest difference {most:.2g}; {at_limit} pixels at the threshold")
    c = as_float(cloud(a.count, 7, 0.02))
    ours = aureole.render(c, width, height, focal, SAME_AS_GSPLAT)[0]
    difference = np.abs(ours - gsplat_picture(formulas, c, width, height, focal))[..., :3]
    print(f"gsplat: a picture of {a.count} splats: mean difference {difference.mean():.2g}, largest {difference.max():.2g}")


def compare_mitsuba(a, aureole):
    import drjit as dr
    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(a.threads)
    width, height, focal = 640, 360, 600.0
    c = as_float(cloud(a.count, 11, 0.0012, degree=3, opacity=(0.2, 0.98)))
    n = len(c["means"])
    tensor = lambda v: mi.TensorXf(np.ascontiguousarray(v, dtype=np.float32))
    fov = 2 * np.degrees(np.arctan(0.5 * width / focal))
    xyzw = c["quats"][:, [1, 2, 3, 0]]
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volprim_rf_basic", "max_depth": -1, "srgb_primitives": False},
        "sensor": {"type": "perspective", "fov": fov, "fov_axis": "x",
                   "to_world": mi.ScalarTransform4f().look_at([0, 0, 0], [0, 0, 1], [0, -1, 0]),
                   "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                            "component_format": "float32"},
                   "sampler": {"type": "independent", "sample_count": 1}},
        "splats": {"type": a.shape, "centers": tensor(c["means"]), "scales": tensor(c["scales"]), "quaternions": tensor(xyzw),
                   "opacities": tensor(c["opacities"][:, None]), "sh_coeffs": tensor(c["sh"].reshape(n, -1)), "extent": 3.0}})
    picture = np.array(mi.render(scene, spp=a.spp, seed=1))[..., :3]
    settings = """<float name="dilation" value="0"/><float name="cutoff" value="3"/><float name="opacity_cap" value="0.9999"/>
<float name="opacity_limit" value="0"/><string name="sorting" value="camera_distance"/><string name="projection" value="tangential"/>
<string name="color_space" value="linear"/><string name="evaluated_at" value="sample"/>"""
    ours = _many_samples(aureole, c, width, height, focal, settings, a.spp)
    difference = np.abs(ours - picture)
    psnr = -10 * np.log10(np.mean((ours - picture) ** 2))
    print(f"mitsuba: {n} splats at {width} x {height}, {a.spp} samples: mean difference {difference.mean():.2g} of colours with the mean "
          f"{picture.mean():.3g}, PSNR {psnr:.1f} dB")
    times, cpu = [], []
    for k in range(5):
        dr.sync_thread()
        begin, cpu_begin = time.perf_counter(), time.process_time()
        dr.eval(mi.render(scene, spp=1, seed=k))
        dr.sync_thread()
        times.append(time.perf_counter() - begin), cpu.append(time.process_time() - cpu_begin)
    theirs, theirs_cpu = min(times[1:]), min(cpu[1:])
    frames = [(aureole.render(c, width, height, focal, settings)[2], aureole.cpu) for _ in range(5)]
    seconds, seconds_cpu = min(f[0] for f in frames), min(f[1] for f in frames)
    print(f"mitsuba: a frame of one sample per pixel: volprim_rf_basic {1000 * theirs:.0f} ms ({1000 * theirs_cpu:.0f} ms of CPU), the whole "
          f"program of aureole with its file {1000 * seconds:.0f} ms ({1000 * seconds_cpu:.0f} ms of CPU): {theirs / seconds:.1f} times as "
          f"fast ({theirs_cpu / seconds_cpu:.1f} by CPU)")


def _many_samples(aureole, c, width, height, focal, settings, spp):
    import OpenEXR
    aureole.render(c, width, height, focal, settings)
    subprocess.run([aureole.binary, "render", "scene.xml", "-o", "many.exr", "--threads", str(aureole.threads), "--spp", str(spp)],
                   cwd=aureole.folder, capture_output=True, text=True, check=True)
    with OpenEXR.File(str(aureole.folder / "many.exr"), separate_channels=True) as f:
        channels = f.channels()
        return np.stack([channels[k].pixels for k in ("splats.R", "splats.G", "splats.B")], axis=2).astype(np.float64)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("peer", choices=["gsplat", "mitsuba"])
    p.add_argument("--aureole", default=str(HERE.parent / "build/release/bin/aureole"))
    p.add_argument("--formulas", help="gsplat's file _torch_impl.py")
    p.add_argument("--single", type=int, default=40, help="splats that are compared one by one")
    p.add_argument("--count", type=int, help="splats of the picture (gsplat: 2000, mitsuba: 100000)")
    p.add_argument("--shape", default="ellipsoidsmesh", help="Mitsuba's shape: ellipsoids or ellipsoidsmesh")
    p.add_argument("--spp", type=int, default=16, help="samples per pixel of the pictures beside Mitsuba's")
    p.add_argument("--threads", type=int, default=2)
    a = p.parse_args()
    a.count = a.count or {"gsplat": 2000, "mitsuba": 100000}[a.peer]
    with tempfile.TemporaryDirectory() as folder:
        {"gsplat": compare_gsplat, "mitsuba": compare_mitsuba}[a.peer](a, Aureole(a.aureole, a.threads, folder))


main()
