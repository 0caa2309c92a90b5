#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders one volume by aureole's `dvr` and by VTK 9 (PyPI, on the CPU) with one camera, transfer function and step, and
prints how much the pictures differ and how long each takes.

The volume is the head of Debian's package `invesalius-examples` (`--head Cranium.inv3`), or without it a skull-like phantom
that this script makes. VTK composites colours as the numbers that a screen shows; the scenes state them as linear, so that the
numbers are the same. VTK's two ray casters shade differently: that by fixed point has
Blinn's highlights, as `dvr` by default. There is no ambient light: VTK multiplies it by that of the lights, which is black by default.
"""
import argparse
import os
import plistlib
import re
import struct
import subprocess
import sys
import tarfile
import tempfile
import time
from pathlib import Path

import numpy as np

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = Path(__file__).resolve().parents[1]
COLORS = [(-1000, 0.3, 0.1, 0.1), (150, 0.55, 0.25, 0.15), (350, 0.88, 0.6, 0.4), (700, 0.95, 0.88, 0.75), (2000, 1, 1, 0.98)]
OPACITIES = [(-1100, 0), (-500, 0), (-300, 0.03), (0, 0.02), (150, 0.02), (300, 0.12), (700, 0.5), (1200, 0.8)]


def read_head(path):
    """The numbers [z, y, x] and the distances of voxels [mm] of an InVesalius project."""
    with tarfile.open(path) as tar:
        members = {Path(m.name).name: m for m in tar.getmembers()}
        main = plistlib.loads(tar.extractfile(members["main.plist"]).read())
        matrix = np.frombuffer(tar.extractfile(members[main["matrix"]["filename"]]).read(), main["matrix"]["dtype"])
    return matrix.reshape(main["matrix"]["shape"]).astype("<f4"), main["spacing"]


def phantom(n):
    """A shell of bone within soft tissue, with noise."""
    x = (np.arange(n) + 0.5) / n * 2 - 1
    z, y, x = np.meshgrid(x, x, x, indexing="ij")
    r = np.sqrt((x / 0.75) ** 2 + (y / 0.9) ** 2 + (z / 0.85) ** 2) + 0.02 * np.sin(9 * x) * np.cos(7 * y + 4 * z)
    values = np.where(r > 1, -1000.0, np.where(np.abs(r - 0.85) < 0.05, 900.0, 40.0))
    values += np.random.default_rng(1).normal(0, 20, values.shape)
    for axis in range(3):
        values = (np.roll(values, 1, axis) + 2 * values + np.roll(values, -1, axis)) / 4
    return values.astype("<f4"), [200 / n] * 3


class Comparison:
    def __init__(self, values, spacing, size, step, shade, folder, program):
        self.values, self.spacing, self.size, self.step, self.shade = values, spacing, size, step, shade
        self.folder, self.program = folder, program
        extent = np.array(values.shape[::-1]) * spacing
        self.center = (np.array(values.shape[::-1]) - 1) * np.array(spacing) / 2  # VTK's volume spans the voxel centres
        self.position = self.center + np.array([0.9, -1.8, 0.5]) * extent.max()
        self.extent = extent

    def scene(self, spp, extra="", method="composite"):
        s = np.array(self.spacing)
        name = self.folder / "volume.vol"
        if not name.exists():
            z, y, x = self.values.shape
            name.write_bytes(struct.pack("<3sB5i6f", b"VOL", 3, 1, x, y, z, 1, 0, 0, 0, 1, 1, 1) + self.values.tobytes())
        top = (np.array(self.values.shape[::-1]) - 1) * s
        numbers = lambda rows: ", ".join(" ".join(f"{v:g}" for v in row) for row in rows)  # noqa: E731
        triple = lambda v: ", ".join(f"{c:.6g}" for c in v)  # noqa: E731
        light = ""
        if self.shade:
            direction = self.center - self.position
            light = (f'<emitter type="directional"><vector name="direction" value="{triple(direction)}"/>'
                     f'<rgb name="irradiance" value="{np.pi},{np.pi},{np.pi}"/></emitter>')
        return f"""<scene version="3.0.0">
<integrator type="dvr"><string name="method" value="{method}"/><float name="step" value="{self.step}"/>
  <float name="termination" value="0.004"/>{'<string name="lighting" value="gradient"/>' if self.shade else ""}
  {extra}<integrator type="direct"/></integrator>
<sensor type="perspective"><string name="fov_axis" value="y"/><float name="fov" value="30"/>
  <transform name="to_world"><lookat origin="{triple(self.position)}" target="{triple(self.center)}" up="0, 0, 1"/></transform>
  <sampler type="sobol"><integer name="sample_count" value="{spp}"/></sampler>
  <film type="hdrfilm"><integer name="width" value="{self.size[0]}"/><integer name="height" value="{self.size[1]}"/>
    <string name="component_format" value="float32"/><rfilter type="box"/></film></sensor>
{light}<shape type="cube"><transform name="to_world"><translate x="1" y="1" z="1"/><scale x="{self.extent[0] / 2}" y="{self.extent[1] / 2}" z="{self.extent[2] / 2}"/>
    <translate x="{-s[0] / 2}" y="{-s[1] / 2}" z="{-s[2] / 2}"/></transform>
  <bsdf type="null"/><medium type="classified" name="interior">
    <volume type="gridvolume" name="value"><string name="filename" value="{name}"/><boolean name="raw" value="true"/>
      <transform name="to_world"><scale x="{self.extent[0]}" y="{self.extent[1]}" z="{self.extent[2]}"/>
        <translate x="{-s[0] / 2}" y="{-s[1] / 2}" z="{-s[2] / 2}"/></transform></volume>
    <string name="opacity" value="{numbers(OPACITIES)}"/><string name="colors" value="{numbers(COLORS)}"/>
    <string name="clip_box" value="0 0 0 {top[0]} {top[1]} {top[2]}"/>
    <float name="ambient" value="0"/><float name="diffuse" value="0.7"/><float name="specular" value="0.2"/><float name="shininess" value="10"/>
  </medium></shape></scene>"""

    def cpu_seconds(self, extra=""):
        """CPU seconds of one sample a pixel, from the difference of five samples and one."""
        used = []
        for spp in (1, 5):
            before = os.times().children_user
            self.ours(spp, extra)
            used.append(os.times().children_user - before)
        return (used[1] - used[0]) / 4

    def ours(self, spp, extra=""):
        """The linear RGB picture and the seconds of rendering alone."""
        import OpenEXR

        scene = self.folder / "scene.xml"
        scene.write_text(self.scene(spp, extra))
        out = self.folder / "ours.exr"
        r = subprocess.run([self.program, "render", scene, "-o", out], capture_output=True, text=True)
        if r.returncode:
            sys.exit(r.stderr)
        seconds = float(re.search(r"in ([\d.]+) s", r.stderr + r.stdout)[1])
        channels = OpenEXR.File(str(out)).channels()
        rgb = channels["RGB"].pixels if "RGB" in channels else channels["RGBA"].pixels[..., :3]
        return np.asarray(rgb, float), seconds

    def vtk(self, step, mapper="gpu", scale=1, frames=3):
        """VTK's picture, averaged over `scale` x `scale` pixels, and the seconds of a frame; sets `vtk_cpu`, its CPU seconds."""
        import vtk
        from vtk.util import numpy_support

        vtk.vtkObject.GlobalWarningDisplayOff()
        image = vtk.vtkImageData()
        image.SetDimensions(*self.values.shape[::-1])
        image.SetSpacing(*self.spacing)
        image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(self.values.ravel(), deep=True))
        ray_cast = vtk.vtkGPUVolumeRayCastMapper() if mapper == "gpu" else vtk.vtkFixedPointVolumeRayCastMapper()
        ray_cast.SetInputData(image)
        ray_cast.SetAutoAdjustSampleDistances(0)
        ray_cast.SetSampleDistance(step)
        if mapper != "gpu":
            ray_cast.SetImageSampleDistance(1)
        opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
        for point in OPACITIES:
            opacity.AddPoint(*point)
        for point in COLORS:
            color.AddRGBPoint(*point)
        look = vtk.vtkVolumeProperty()
        look.SetColor(color)
        look.SetScalarOpacity(opacity)
        look.SetScalarOpacityUnitDistance(1)
        look.SetInterpolationTypeToLinear()
        look.SetShade(self.shade)
        look.SetAmbient(0), look.SetDiffuse(0.7), look.SetSpecular(0.2), look.SetSpecularPower(10)
        volume = vtk.vtkVolume()
        volume.SetMapper(ray_cast)
        volume.SetProperty(look)
        renderer = vtk.vtkRenderer()
        renderer.AddVolume(volume)
        renderer.AutomaticLightCreationOff()
        light = vtk.vtkLight()
        light.SetPositional(0)
        light.SetPosition(*self.position), light.SetFocalPoint(*self.center)
        renderer.AddLight(light)
        window = vtk.vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(self.size[0] * scale, self.size[1] * scale)
        window.AddRenderer(renderer)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*self.position), camera.SetFocalPoint(*self.center), camera.SetViewUp(0, 0, 1), camera.SetViewAngle(30)
        renderer.ResetCameraClippingRange()
        window.Render()
        best, self.vtk_cpu = float("inf"), None
        for _ in range(frames):
            camera.Azimuth(0)
            ray_cast.Modified()
            start, start_cpu = time.perf_counter(), time.process_time()
            window.Render()
            grab = vtk.vtkWindowToImageFilter()
            grab.SetInput(window)
            grab.ReadFrontBufferOff()
            grab.Update()
            best = min(best, time.perf_counter() - start)
            self.vtk_cpu = min(self.vtk_cpu or best * 64, time.process_time() - start_cpu)
        data = numpy_support.vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
        picture = data.reshape(self.size[1] * scale, self.size[0] * scale, -1)[::-1, :, :3] / 255
        return picture.reshape(self.size[1], scale, self.size[0], scale, 3).mean((1, 3)), best


def difference(a, b):
    """Mean absolute difference and mean difference, as parts of the mean of b where b is not black."""
    seen = b.max(-1) > 0.01
    return np.abs(a - b)[seen].mean() / b[seen].mean(), (a - b)[seen].mean() / b[seen].mean()


def cast_by_numpy(c):
    """The picture of a comparison by a ray caster of numpy, which shades as VTK's caster by fixed point does: diffuse and specular
    light are found at each voxel from central differences, for one direction of view, and interpolated between voxels. One ray
    passes through the centre of each pixel."""
    values, spacing = c.values.astype(np.float32), np.array(c.spacing)
    forward = (c.center - c.position) / np.linalg.norm(c.center - c.position)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    gz, gy, gx = np.gradient(values)
    gradient = np.stack([gx / spacing[0], gy / spacing[1], gz / spacing[2]], -1)
    size = np.linalg.norm(gradient, axis=-1)
    cosine = np.abs(gradient @ -forward) / np.where(size > 0, size, 1)  # light and viewer are on one side
    grids = [values.ravel(), cosine.astype(np.float32).ravel(), (cosine.astype(np.float32) ** 10).ravel()]
    w, h = c.size
    y, x = np.mgrid[0:h, 0:w]
    scale = np.tan(np.radians(15)) / (h / 2)
    d = forward + ((x + 0.5 - w / 2) * scale)[..., None] * right - ((y + 0.5 - h / 2) * scale)[..., None] * up
    d = (d / np.linalg.norm(d, axis=-1, keepdims=True)).reshape(-1, 3)
    n = np.array(values.shape[::-1])
    top = (n - 1) * spacing
    with np.errstate(divide="ignore"):
        t0, t1 = (0 - c.position) / d, (top - c.position) / d
    begin, end = np.minimum(t0, t1).max(-1), np.maximum(t0, t1).min(-1)
    light, passed = np.zeros_like(d), np.ones(len(d))
    active = np.flatnonzero(end > begin)
    k = 0
    while len(active):
        t = begin[active] + (k + 0.5) * c.step
        active, t = active[t < end[active]], t[t < end[active]]
        at = np.clip((c.position + d[active] * t[:, None]) / spacing, 0, n - 1.001)
        cell = at.astype(np.int64)
        f = (at - cell).astype(np.float32)
        base = (cell[:, 2] * n[1] + cell[:, 1]) * n[0] + cell[:, 0]

        def look_up(grid, f=f, base=base):
            lines = [grid[base + o] + f[:, 0] * (grid[base + o + 1] - grid[base + o]) for o in (0, n[0], n[0] * n[1], n[0] * n[1] + n[0])]
            return (1 - f[:, 2]) * (lines[0] + f[:, 1] * (lines[1] - lines[0])) + f[:, 2] * (lines[2] + f[:, 1] * (lines[3] - lines[2]))

        s = look_up(grids[0])
        alpha = 1 - (1 - np.minimum(np.interp(s, *np.array(OPACITIES).T), 0.9999)) ** c.step
        seen = alpha > 0
        if seen.any():
            f, base = f[seen], base[seen]
            diffuse, specular = look_up(grids[1], f, base), look_up(grids[2], f, base)
            table = np.array(COLORS).T
            color = np.stack([np.interp(s[seen], table[0], row) for row in table[1:]], -1)
            rays = active[seen]
            if c.shade:
                color = 0.7 * color * diffuse[:, None] + 0.2 * specular[:, None]
            light[rays] += (passed[rays] * alpha[seen])[:, None] * color
            passed[rays] *= 1 - alpha[seen]
        active = active[passed[active] > 0.004]
        k += 1
    return light.reshape(h, w, 3)


def reduced(picture, factor=4):
    h, w = picture.shape[:2]
    return picture.reshape(h // factor, factor, w // factor, factor, 3).mean((1, 3))


def text(name, value):
    return f'<string name="{name}" value="{value}"/>'


def settings_of():
    """Ways of `dvr` to the picture: name, step in voxels (of the smallest distance), parameters."""
    ways = [(f"post, {s:g} voxels", s, "") for s in (0.25, 0.5, 0.6, 0.75, 1, 1.5)]
    interleaved = '<boolean name="jitter" value="true"/>' + text("jitter_pattern", "interleaved")
    ways += [(f"post, interleaved, {s:g} voxels", s, interleaved) for s in (0.5, 0.75, 0.8, 0.85, 1, 1.25)]
    ways += [(f"preintegrated, {s:g} voxels", s, text("classification", "preintegrated")) for s in (0.5, 1)]
    ways += [(f"by_opacity {o:g}, from {s:g} voxels", s, text("steps", "by_opacity") + f'<float name="step_opacity" value="{o}"/>')
             for s, o in ((0.5, 0.005), (0.5, 0.02), (0.5, 0.05), (0.25, 0.02), (0.25, 0.05))]
    ways += [(f"adaptive, tolerance {t:g}", 1, text("steps", "adaptive") + f'<float name="tolerance" value="{t}"/>')
             for t in (0.1, 0.03)]
    return ways


def equal_error(make, voxel, shade):
    """Times of `dvr` to the error of VTK's casters, in pictures of one sample a pixel that are then averaged over 4 x 4 pixels.
    The reference has a quarter of VTK's step and four samples a pixel. CPU seconds hardly depend on other work on the machine.
    Prints a table; `make(step)` returns the comparison with that step."""
    truth = reduced(make(voxel / 8).ours(4)[0])
    rows, ours = [], []
    for mapper, name in (("fixed", "VTK by fixed point"), ("gpu", "VTK by OpenGL")):
        for step in (0.5, 1) if mapper == "fixed" else (0.5,):
            c = make(voxel * step)
            picture, seconds = c.vtk(voxel * step, mapper)
            rows.append((difference(reduced(picture), truth)[0], c.vtk_cpu, seconds, f"{name}, {step:g} voxels"))
    for name, step, extra in settings_of():
        c = make(voxel * step)
        picture, seconds = c.ours(1, extra)
        seconds = min(seconds, c.ours(1, extra)[1])
        ours.append((difference(reduced(picture), truth)[0], c.cpu_seconds(extra), seconds, name))
    print("     error  CPU seconds  seconds  of a picture")
    for error, cpu, seconds, name in rows + ours:
        print(f"  {100 * error:6.2f} % {cpu:12.2f} {seconds:8.2f}  {name}")
    for error, cpu, seconds, name in rows:
        fast = min((row for row in ours if row[0] <= error), key=lambda row: row[1], default=None)
        if fast:
            print(f"  to the error of {name}: {fast[1] / cpu:.2f} of its CPU time, {fast[2] / seconds:.2f} of its time, by {fast[3]}")
        else:
            print(f"  to the error of {name}: not reached")


def plot_steps(make, voxel, file):
    """Draws the error of each discrete form by its step, for the unshaded picture."""
    import matplotlib
    import matplotlib.ticker

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    truth = make(voxel / 32).ours(1)[0]
    steps = [0.0625, 0.125, 0.25, 0.5, 1, 2, 4, 8]
    forms = [("opacity_weighted, exponential", ""), ("premultiplied", text("form", "premultiplied")),
             ("taylor", text("alpha", "taylor")), ("preintegrated", text("classification", "preintegrated"))]
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    forms.append(("by_opacity, from that step", text("steps", "by_opacity")))
    for name, extra in forms:
        found = [make(voxel * s).ours(1, extra) for s in steps]
        errors = [100 * difference(picture, truth)[0] for picture, _ in found]
        left.loglog(steps, errors, "o-", label=name)
        right.loglog([seconds for _, seconds in found], errors, "o-", label=name)
        print(f"{name}: " + ", ".join(f"{s:g} voxels {e:.3f} %" for s, e in zip(steps, errors)))
    found = []
    for tolerance in (0.3, 0.1, 0.03, 0.01, 0.003, 0.001):
        found.append(make(voxel).ours(1, text("steps", "adaptive") + f'<float name="tolerance" value="{tolerance}"/>'))
        print(f"adaptive, tolerance {tolerance:g}: {100 * difference(found[-1][0], truth)[0]:.3f} %")
    right.loglog([seconds for _, seconds in found], [100 * difference(picture, truth)[0] for picture, _ in found], "s--", label="adaptive")
    left.set_xlabel("step [voxels]"), right.set_xlabel("seconds of a picture")
    left.set_ylabel("mean absolute error [% of the mean]")
    for axis in (left, right):
        axis.grid(alpha=0.3), axis.legend(fontsize=8)
    right.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    figure.tight_layout()
    figure.savefig(file, dpi=110)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--head", type=Path, help="Cranium.inv3 of Debian's package invesalius-examples")
    p.add_argument("--phantom", type=int, default=256, help="voxels along each axis of the phantom")
    p.add_argument("--size", type=int, nargs=2, default=[1280, 720])
    p.add_argument("--program", type=Path, default=ROOT / "build/release/bin/aureole")
    p.add_argument("--keep", type=Path, help="a folder for the scene and the pictures")
    p.add_argument("--plot", type=Path, help="writes a plot of steps against error of dvr alone, without VTK, as this file")
    p.add_argument("--skip-differences", action="store_true", help="times alone")
    a = p.parse_args()
    values, spacing = read_head(a.head) if a.head else phantom(a.phantom)
    with tempfile.TemporaryDirectory() as name:
        folder = a.keep or Path(name)
        folder.mkdir(exist_ok=True, parents=True)
        (folder / "volume.vol").unlink(missing_ok=True)  # of an earlier run, maybe with another volume
        voxel = min(spacing)
        print(f"load of the machine {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
        print(f"volume {values.shape[::-1]}, spacing {[round(float(s), 3) for s in spacing]} mm, picture {a.size[0]} x {a.size[1]}")
        if a.plot:
            plot_steps(lambda step: Comparison(values, spacing, [640, 360], step, False, folder, a.program), voxel, a.plot)
            return
        for shade in (False, True):
            print("shaded" if shade else "unshaded")
            c = Comparison(values, spacing, a.size, voxel / 2, shade, folder, a.program)
            if not a.skip_differences:
                reference = Comparison(values, spacing, [s // 4 for s in a.size], voxel / 2, shade, folder, a.program)
                ours, _ = reference.ours(64)
                pictures = {"ours": ours}
                for mapper, name in (("gpu", "OpenGL"), ("fixed", "fixed point")):
                    pictures[mapper], _ = reference.vtk(reference.step, mapper, scale=4, frames=1)
                    mean_abs, mean = difference(ours, pictures[mapper])
                    print(f"  from VTK by {name}: mean absolute difference {100 * mean_abs:.2f} %, mean difference {100 * mean:+.2f} %")
                small, large = (Comparison(values, spacing, [s // n for s in a.size], voxel / 2, shade, folder, a.program) for n in (8, 2))
                ours, theirs = small.ours(64)[0], small.vtk(small.step, "fixed", scale=4, frames=1)[0]
                numpy = reduced(cast_by_numpy(large))
                print(f"  {small.size[0]} x {small.size[1]}, by numpy with {'light found at the voxels' if shade else 'no light'}:")
                for name, found, expected in (("numpy from dvr", numpy, ours), ("numpy from VTK by fixed point", numpy, theirs),
                                              ("dvr from VTK by fixed point", ours, theirs)):
                    mean_abs, mean = difference(found, expected)
                    print(f"    {name}: mean absolute difference {100 * mean_abs:.2f} %, mean difference {100 * mean:+.2f} %")
                if a.keep:
                    np.savez(folder / f"{'shaded' if shade else 'unshaded'}.npz", **pictures)
            seconds = min(c.ours(1)[1] for _ in range(3))
            _, theirs = c.vtk(c.step)
            _, fixed = c.vtk(c.step, "fixed")
            print(f"  seconds of a picture with the same step: dvr {seconds:.2f}, VTK by OpenGL {theirs:.2f}, by fixed point {fixed:.2f}")
            small = Comparison(values, spacing, [640, 360], voxel / 2, shade, folder, a.program)
            for name, extra in (("half a voxel", ""), ("by_opacity", text("steps", "by_opacity"))):
                frame, cpu = min(small.ours(1, extra)[1] for _ in range(5)), small.cpu_seconds(extra)
                print(f"  640 x 360, steps {name}: {1 / frame:.1f} frames a second, {cpu:.2f} CPU seconds each")
            equal_error(lambda step: Comparison(values, spacing, a.size, step, shade, folder, a.program), voxel, shade)


if __name__ == "__main__":
    main()
