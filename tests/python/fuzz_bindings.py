#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calls every callable of the package, the compiled module included, with arguments that are wrong in some way.

    PYTHONPATH=build/release/python .venv/bin/python tests/python/fuzz_bindings.py --cases 50000 --seed 3 --jobs 4

Callables are found by looking at the package, so that new ones are covered: their arguments are made of what `VALID` has for names of
parameters, then one or two are replaced. Cases run in child processes with limits of memory and time. What ends a child, or raises what no
user can understand, is printed with the Python that does it again.
"""
from __future__ import annotations

import argparse
import collections
import decimal  # noqa: F401  texts below use it
import enum
import faulthandler
import fractions  # noqa: F401
import inspect
import json
import os
import pathlib
import random
import re
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np

os.environ.setdefault("MPLBACKEND", "Agg")

import aureole  # noqa: E402
from aureole import _aureole, optics, plot, spectrum  # noqa: E402, F401

SOFT_S, HARD_S = 2.0, 10.0  # a call is interrupted, which it has to obey; and is taken for hanging
MEMORY = 3 << 29
FOLDER = pathlib.Path(tempfile.gettempdir()) / f"aureole-fuzz-{os.getuid()}"


class Mine(Exception):
    """Raised by objects of the fuzzer; any call may propagate it."""


# ---------------------------------------------------------------- valid objects, new ones for each case

SPHERES = {
    "type": "scene", "integrator": {"type": "path", "max_depth": 3},
    "sensor": {"type": "perspective", "fov": 40.0, "to_world": aureole.Transform.look_at([0, 0, 5], [0, 0, 0]),
               "film": {"type": "hdrfilm", "width": 6, "height": 4, "rfilter": {"type": "box"}},
               "sampler": {"type": "independent", "sample_count": 4}},
    "glass": {"type": "roughdielectric", "alpha": 0.2},
    "ball": {"type": "sphere", "radius": 1.0, "bsdf": {"type": "ref", "id": "glass"}},
    "mesh": {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]],
             "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "data": [[[0.1], [0.5]]], "raw": True}}},
    "lamp": {"type": "rectangle", "to_world": aureole.Transform.translate([0, 3, 0]), "emitter": {"type": "area", "radiance": 2.0}},
    "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.1, 0.2, 0.3]}},
}
XML = ('<scene version="3.0.0"><default name="n" value="4"/><integrator type="path"/><sensor type="perspective"><film type="hdrfilm">'
       '<integer name="width" value="$n"/><integer name="height" value="3"/></film><sampler type="independent"><integer name="sample_count" '
       'value="4"/></sampler></sensor><bsdf type="diffuse" id="grey"><rgb name="reflectance" value=".5,.4,.3"/></bsdf><shape type="sphere">'
       '<ref id="grey"/></shape><emitter type="constant"/></scene>')


def scene(description=None):
    return aureole.load_dict(SPHERES if description is None else description)


def bsdf(kind="roughconductor", **more):
    return aureole.load_dict({"type": kind, **more}, family="bsdf")


class Lambert:
    """A BSDF of a user's, whose answers can be wrong."""

    lobes = ("diffuse", "reflect")

    def __init__(self, answer=None):
        self.answer = answer

    def eval(self, wi, wo, wavelength):
        return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), wo[:, 2] / np.pi, 0) if self.answer is None else self.answer

    def pdf(self, wi, wo, wavelength):
        return self.eval(wi, wo, wavelength)

    def sample(self, wi, wavelength, u):
        if self.answer is not None:
            return self.answer
        r, phi = np.sqrt(u[:, 1]), 2 * np.pi * u[:, 2]
        wo = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 1])], -1)
        return wo, self.eval(wi, wo, wavelength), self.pdf(wi, wo, wavelength)


def image():
    return aureole.Image(np.linspace(0, 1, 36).reshape(3, 4, 3))


def rendered():
    return aureole.render(scene(), spp=1, threads=1, progress=False)


def texture():
    return aureole.load_dict({"type": "bitmap", "data": [[[0.1], [0.5]]], "raw": True})


def emitter():
    return aureole.load_dict({"type": "constant", "radiance": 1.0})


def aperture():
    return aureole.load_dict({"type": "circle", "radius": "5um"}, family="aperture")


_reports = {}


def report():
    if not _reports:
        _reports[0] = aureole.check(bsdf("diffuse"), samples=1000)
    return _reports[0]


def lattice():
    return np.stack(np.meshgrid(np.arange(8.0), np.arange(8.0)), -1).reshape(-1, 2)


def file(name):
    """A new file of that name, an EXR."""
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / f"{os.getpid()}-{name}"
    image().save(FOLDER / f"{os.getpid()}.exr")
    os.replace(FOLDER / f"{os.getpid()}.exr", path)
    return path


def fog():
    return aureole.load_dict({"type": "homogeneous", "sigma_t": 2.0, "albedo": 0.5}, family="medium")


def torn_bytes(content, number):
    """Content with some bytes changed or cut off."""
    rng = random.Random(number)
    data = bytearray(content)
    for _ in range(rng.choice([0, 1, 3, 20])):
        data[rng.randrange(len(data))] = rng.choice([0, 1, 127, 128, 255])
    return bytes(data[: rng.choice([len(data), rng.randrange(len(data) + 1)])])


def text_file(text, ending="xml"):
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / f"{os.getpid()}.{ending}"
    path.write_text(text, errors="surrogatepass")
    return path


LENS = "name doublet\n61.5 6 bk7 25\n-44.7 2.5 sf5 25\n-129.9 95.9 air 24 stop\n"
LAMP = ("IESNA:LM-63-2002\n[TEST] a\n[TESTLAB] b\n[ISSUEDATE] c\n[MANUFAC] d\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n300 200 0\n")
OFFICE = ('<scene version="3.0.0"><sensor type="powermap"><string name="measure" value="irradiance"/><film type="hdrfilm"><integer name="width" '
          'value="3"/><integer name="height" value="2"/><string name="quantity" value="illuminance"/></film><sampler type="sobol"><integer '
          'name="sample_count" value="2"/></sampler></sensor><shape type="rectangle"><transform name="to_world"><translate z="-1"/></transform>'
          '</shape><emitter type="point"><point name="position" x="0" y="0" z="1"/><string name="amount" value="100 cd"/></emitter></scene>')
LAMP_SCENE = '<scene version="3.0.0"><emitter type="point"><string name="amount" value="100 lm"/></emitter></scene>'


def camera_scene(film=None, sensor=None):
    """A scene of six pixels with another film or sensor."""
    return aureole.load_dict({**SPHERES, "sensor": {**SPHERES["sensor"], **(sensor or {}), "film": {
        **(film or {"type": "specfilm", "bins": 4}), "width": 6, "height": 4, "rfilter": {"type": "box"}}}})


def field_scene():
    return camera_scene({"type": "hdrfilm"}, {"type": "lightfield", "fov": 1.0, "views_x": 2, "aperture_width": 0.4, "plane_distance": 4.0, "field_width": 3.0})


# ---------------------------------------------------------------- wrong ones


class RaisingArray:
    def __array__(self, *a, **k):
        raise Mine


class LyingArray:
    __array_interface__ = {"version": 3, "shape": (3,), "typestr": "<f8", "data": (0, True)}
    shape = (10**9, -1)
    ndim = "many"
    dtype = None

    def __len__(self):
        return 2**62

    def __getitem__(self, i):
        raise Mine


class Str(str):
    def __str__(self):
        raise Mine


class Int(int):
    pass


class Index:
    def __index__(self):
        return 3

    def __float__(self):
        return 3.0


class Float(float):
    def __float__(self):
        raise Mine


class BadRepr:
    def __repr__(self):
        raise Mine

    def __eq__(self, other):
        raise Mine

    __hash__ = object.__hash__


class Odd:
    pass


Odd.__qualname__ = "\u00e9 %s {0}"


class Path:
    def __init__(self, value):
        self.value = value

    def __fspath__(self):
        return self.value


class Changing(collections.abc.Mapping):
    def __len__(self):
        return 5

    def __iter__(self):
        return iter(["type", "type", 3, None, "\0"])

    def __getitem__(self, key):
        return random.choice(["sphere", "scene", "diffuse"])


class Array(np.ndarray):
    pass


def deep(n):
    value = []
    for _ in range(n):
        value = [value]
    return value


def deep_dict(n):
    value = {"type": "diffuse"}
    for _ in range(n):
        value = {"type": "twosided", "bsdf": value}
    return value


def cyclic(kind):
    value = kind()
    if kind is list:
        value.append(value)
    else:
        value.update(type="twosided", bsdf=value)
    return value


def spin():
    """Looks at no signals, as a loop in C++ that forgets to ask."""
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])
    while True:
        pass


def throw(error):
    raise error


def closed():
    with open(os.devnull) as f:
        pass
    return f


def raising(*arguments, **more):
    raise Mine


WRONG = """None|True|0|-1|1|3|2.5|-0.0|float('nan')|float('inf')|-float('inf')|1e308|-1e308|5e-324|1e-30|1e30|2**31|2**32|2**53+1|2**63|2**64
-2**63-1|10**400|10**5000|1j|complex('nan')|np.float16(1)|np.float32('nan')|np.longdouble('1e4000')|np.int8(-1)|np.uint64(2**64-1)|np.bool_(1)
np.datetime64('2020')|decimal.Decimal('1e999')|fractions.Fraction(1,3)|Int(2)|Index()|Float(1)|''|'a'|'\\0'|'a\\0b'|'\\ud800'|'\\U0001d54f\\u0301'|'x'*100000
'<bsdf/>'|'$x'|'../../nothing'|'%s%n{0}'|'\\n\\t\\r'|'nan'|'1e999'|Str('a')|b''|b'\\xff'|bytearray(3)|memoryview(b'abcdefgh')|[]|()|{}|[[1],[2,3]]
[None]|['a']|[1,'a']|range(3)|{1,2}|iter([1,2])|(i for i in range(3))|deep(40)|deep(5000)|cyclic(list)|cyclic(dict)|deep_dict(150)|deep_dict(5000)
{'a':1}|{1:2}|{'type':None}|{'type':np.ones(2)}|{'type':'\\ud800'}|{'type':'a\\0'}|{'type':'diffuse','a\\nb':1}|{'type':'diffuse','\\ud800':1}|Changing()
collections.OrderedDict(type='diffuse')|np.array(1.0)|np.array('a')|np.empty(0)|np.zeros((0,3))|np.zeros((3,0))|np.ones((1,)*10)|np.ones((1,)*32)
np.ones((6,6))[::2,::-1]|np.arange(6.)[::-1]|np.arange(3.)|np.ones((2,3))|np.eye(4)|np.ones((4,4,4))|np.ones(3,'>f8')|np.ones(3,'f2')|np.ones(3,'c16')
np.ones(3,'g')|np.ones(3,'O')|np.array([Odd()],object)|np.array([10**400],object)|np.ones(3,'U3')|np.ones(3,'S3')|np.zeros(3,[('a','f8'),('b','i4')])
np.zeros(3,'V7')|np.zeros(3,'m8[s]')|np.ones(3,bool)|np.ones(3,'u8')*2**64|np.ma.array([1.,2.,3.],mask=[0,1,0])|np.ma.array(np.ones((2,3)))
np.broadcast_to(1.0,2**40)|np.broadcast_to(0.5,(2**31,2**31))|np.broadcast_to(1.0,(2**20,2**20,3))|np.broadcast_to(np.float32(1),(3,2**33))
np.broadcast_to([0,0,1.0],(2**40,3))|np.broadcast_to(1.0,(0,2**60))|np.frombuffer(bytes(25),'f8',3,1)|np.full(3,np.nan)|np.full((2,3),np.inf)
np.array([0,0,1.0]).view(Array)|np.matrix([[1.,2.]])|np.ones(3).__array_interface__|np.lib.stride_tricks.as_strided(np.ones(3),(3,),(-0,))|np.full((5,5),1e308)
object()|int|np.ndarray|lambda:0|raising|NotImplemented|...|slice(None)|closed()|np|aureole|Odd()|Odd|BadRepr()|RaisingArray()|LyingArray()|Path(3)
Path('\\0')|Path(b'x')|pathlib.Path('/')|pathlib.Path('/nonexistent/a.exr')|'/dev/null'|'.'|bsdf()|bsdf|scene()|image()|texture()|emitter()|aperture()
aureole.Transform()|optics.circle(1e-6)|Lambert()|Lambert|Lambert(float('nan'))|Lambert(raising)|Lambert(np.ones(7))|Lambert((1,2,3))|np.ones(8)[None]
aureole.Transform.scale(0)|aureole.Transform.scale([1,-1,1e-30])|Exception|enum.Enum
_aureole.OpenScene.__new__(_aureole.OpenScene)|_aureole.Bsdf.__new__(_aureole.Bsdf)|_aureole.Picture.__new__(_aureole.Picture)""".replace("\n", "|").split("|")
NUMBERS = ["0", "-1", "1", "0.5", "float('nan')", "float('inf')", "-float('inf')", "1e308", "-1e308", "1e-320", "2**31", "2**63", "2**64", "-2**63",
           "1e18", "1e5", "True", "1e-12", "10**400"]
ARRAYS = ["np.empty(0)", "np.full(3, np.nan)", "np.full(3, np.inf)", "np.full(3, -1e308)", "np.zeros(1)", "np.full(2, 1e308)", "np.full(2, 1e-300)", "np.arange(3.)",
          "np.arange(4.)[::-1]", "np.zeros((2, 3))", "np.full((2, 3), np.nan)", "np.zeros((0, 3))", "np.zeros((3, 0))", "np.zeros((1, 2, 2))", "np.full((4, 4), 1e30)",
          "np.zeros((0, 2, 2))", "np.zeros((5, 2), complex)", "np.full(3, np.nan, complex)", "np.full(2, 2**62)", "np.ones(3, np.int64)", "np.ones((3, 3), np.float32)",
          "np.broadcast_to(1.0, 2**40)"]

UP, OUT = "[0, 0, 1.0]", "[[0, 0.6, 0.8], [0, 0, 1]]"
#: Valid arguments by the names of parameters.
VALID = {
    "scene": ["scene()"], "spp": ["2", "4"], "seed": ["1"], "threads": ["1"], "time": ["0.01"], "replicates": ["2"], "progress": ["False", "raising"],
    "start": ["None", "rendered()"], "step": ["16"], "description": ["SPHERES", "mutated(SPHERES, R)", "{'type': 'diffuse'}"], "family": ["None", "'bsdf'"],
    "integrator": ["''", "'path'"], "sampler": ["''", "'sobol'"], "wavelengths": ["(360.0, 830.0)", "np.linspace(400, 700, 8)"], "changes": ["{'glass.alpha': 0.3}", "mutated({'glass.alpha': 0.3}, R)"],
    "path": ["text_file(XML)", "'glass.alpha'", "file('a.exr')", "file('b.png')", "'ball.bsdf'", "torn(file('c.exr'), R)"], "text": ["XML", "torn_text(XML, R)", "'<bsdf type=\"diffuse\"/>'"],
    "channel": ["'R'", "['R', 'G']"], "channels": ["['a', 'b', 'c']", "'RGB'"], "array": ["np.ones((3, 4, 3))", "np.ones((3, 4))"], "exposure": ["1.0"], "prefix": ["'glass'"],
    "x": ["[0.5, 3]"], "m": ["1.33", "1.5 + 0.1j"], "mu": ["np.linspace(-1, 1, 5)"], "cos_theta": ["[0.5, 1]"], "eta": ["1.5", "0.2 + 3j"], "radius": ["5e-6", "'5um'"], "radius_x": ["5e-6"],
    "radius_y": ["2e-6"], "inner_radius": ["1e-6"], "sides": ["6"], "points": ["5"], "inner_ratio": ["0.5"], "vertices": ["[(0, 0), (1e-6, 0), (0, 1e-6)]"], "holes": ["[]"], "centroid": ["True"],
    "open": ["np.eye(5)"], "pixel_size": ["1e-7"], "width": ["1e-6"], "height": ["2e-6"], "q": ["[[0, 1e5]]"], "qa": ["[0.5, 3.0]"], "area_fraction": ["0.4"], "model": ["'poisson'"], "n": ["50"],
    "snapshots": ["2"], "sweeps": ["2"], "positions": ["lattice()", "lattice()[None]"], "box": ["8.0", "[8.0, 8.0]"], "r_max": ["3.0"], "bins": ["10"], "edges": ["None", "[0.5, 1.0, 2.0]"], "periodic": ["True", "False"],
    "tiles": ["2"], "q_max": ["8.0"], "rings": ["5"], "per_ring": ["10"], "ra": ["np.linspace(0, 10, 20)"], "g": ["np.ones(20)"], "s": ["np.ones(2)"], "r": ["np.linspace(0, 10, 20)"], "discs": ["200"], "kind": ["'square'"],
    "jitter": ["0.1"], "domain": ["3.0"], "angle": ["0.5"], "random_orientation": ["False"], "wavelength": ["[400, 550.0]", "550"], "name": ["'D65'", "'bk7'"], "normalize": ["'table'"], "outside": ["'zero'"],
    "temperature": ["5000"], "values": ["[0.1, 0.5]"], "illuminant": ["'D65'"], "encoded": ["True", "[0.5, 0.1]"], "xyz": ["[1, 1, 1.0]"], "linear": ["[0.2]"], "rgb": ["[0.2, 0.1, 0.9]"], "unbounded": ["True"],
    "method": ["'table'"], "dispersion": ["True"], "bsdf": ["bsdf()", "bsdf('diffuse')", "bsdf('dielectric')", "Lambert()"], "theta_i": ["30"], "log": ["True"], "decades": ["4"], "cosine": ["False"], "samples": ["1000"],
    "ax": ["None"], "side": ["'transmission'"], "phi_i": ["20"], "resolution": ["16"], "cmap": ["'magma'"], "label": ["'a'"], "fill": ["False"], "unit": ["'nm'"], "theta": ["0.5"], "polar": ["True"], "color": ["'r'"],
    "correlation": ["'poisson'"], "scatterer": ["'discs'"], "lamp": ["'A'", "550.0", "([400, 700], [1, 2])"], "lamp_diameter": ["0.5"], "field": ["5.0"], "azimuth": ["10"], "error": ["0.1"], "report": ["report()"], "axes": ["None"],
    "lossless": ["False"], "reciprocal": ["True"], "significance": ["0.01"], "two_sided": ["True"], "may_fail": ["True"], "index_ratio": ["1.5"], "largest_energy": ["1"], "tolerance": ["0.002"], "mode": ["'radiance'"],
    "wi": [UP, "np.array(" + OUT + ")"], "wo": [OUT], "u": ["[0.1, 0.5, 0.7]"], "uv": ["[0.2, 0.3]"], "phi": ["0.1"], "part": ["'reflect'"], "return_error": ["True"], "matrix": ["np.eye(4)"], "offset": ["[1, 2, 3]"],
    "factor": ["2", "[1, 2, 3]"], "axis": ["[0, 1, 0]"], "origin": ["[0, 0, 1]"], "target": ["[0, 0, 0]"], "up": ["[0, 1, 0]"], "other": ["aureole.Transform()"], "value": ["0.2", "mutated({'type': 'diffuse'}, R)"],
    "defines": ["[('n', '5')]"], "given": ["{}", "{'a': bsdf()}"], "file": ["'<text>'"], "instance": ["Lambert()"], "args": [], "kwargs": [], "pixels": ["np.ones((2, 3, 3), np.float32)"], "arguments": ["['aureole', '--version']"],
    "min_nm": ["360.0"], "max_nm": ["830.0"], "begin": ["0"], "end": ["4"], "time_limit_s": ["0.0"], "compiled": ["_aureole.poisson_factor()"], "problems": ["['a']"], "nm": ["np.array([400.0, 500.0])"],
    "result": ["np.empty(2)", "np.empty((4, 2))", "np.empty(2, complex)"], "s1": ["np.empty(2, complex)"], "s2": ["np.empty(2, complex)"], "reference": ["[0, 0, 0.0]"], "position": ["[0, 0, 1.0]"], "point": ["[0, 0, 1.0]"],
    "direction": [UP], "dtype": ["'f8'"], "copy": ["True"], "self": [], "table": ["True", "False"],
}
#: How to get an object of a class.
INSTANCES = {
    "aureole.Scene": ["scene()"], "aureole.Image": ["image()", "rendered()"], "aureole.Transform": ["aureole.Transform.rotate([0, 1, 0], 30)"], "aureole.Texture": ["texture()"], "aureole.Emitter": ["emitter()"],
    "aureole.Aperture": ["aperture()"], "aureole.Bsdf": ["bsdf()", "bsdf('dielectric')", "bsdf('blendbsdf', a={'type': 'diffuse'}, b={'type': 'conductor'}, weight=0.3)", "_aureole.python_bsdf(Lambert())"],
    "aureole.ExposureData": ["aureole.expose(camera_scene(), 1, exposure=0.01, progress=False)"], "aureole.LightField": ["aureole.lightfield(field_scene(), 1, progress=False)"],
    "aureole.UgrData": ["aureole.ugr(text_file(LAMP, 'ies'), spacing=1, opening=(1, 1, 0))"],
    "aureole.LuminaireData": ["aureole.goniophotometer(text_file(LAMP, 'ies'))"], "aureole.PhotometryData": ["aureole.photometry(aureole.load_string(OFFICE), 1, progress=False)"],
    "aureole.LensData": ["aureole.lens(text_file(LENS, 'lens'), rays=4)"], "aureole.IlluminationData": ["aureole.illumination(text_file(OFFICE), 1, runs=2, progress=False)"],
    "aureole._aureole.RawPicture": ["aureole.expose(camera_scene(), 1, exposure=0.01, progress=False)._raw[0]"],
    "aureole.CheckReport": ["report()"], "aureole.CheckRecord": ["report().checks[0]"], "aureole.optics.ApertureShape": ["optics.circle(5e-6)", "optics.mask(np.eye(4), 1e-6)"],
    "aureole.optics.PlaneStack": ["optics.PlaneStack([optics.StackLayer(1, 0.1, [0.9, 1], g=0.5)], streams=4)"],
    "aureole._aureole.PlaneStacks": ["optics.PlaneStack([optics.StackLayer(1, 0.1, [0.9, 1], g=0.5)], streams=4)._stacks"],
    "aureole.optics.StructureFactor": ["optics.StructureFactor.percus_yevick(0.4)"], "aureole._aureole.OpenScene": ["scene()._open"], "aureole._aureole.Picture": ["rendered()._picture", "image()._picture"],
    "aureole.optics.EdgeWaves": ["optics.EdgeWaves.polygon([(0, 0), (1, 0), (0, 1)], sigma=1.0)"],
    "aureole._aureole.DiffractingEdges": ["_aureole.DiffractingEdges(np.array([0, 0, 1.0, 0]), np.ones(2, complex), 'beam', 1.0)"],
    "aureole._aureole.PartSum": ["_aureole.PartSum(rendered()._picture)"], "aureole._aureole.Array": ["_aureole.Array(np.ones((2, 3)))"], "aureole._aureole.StructureFactor": ["_aureole.percus_yevick_factor(0.4)"], "aureole._aureole.Object": ["scene()['sensor.film']"],
}
#: Calls that the names of parameters do not get right.
EXAMPLES = {
    "_aureole.mie": [["np.array([0.5, 3])", "np.array([1.3, 1.5], complex)", "np.empty((4, 2))"]], "_aureole.mie_amplitudes": [["np.ones(2)", "np.full(2, 1.5 + 0j)", "np.zeros(3)", "np.empty(6, complex)", "np.empty(6, complex)"]],
    "_aureole.mie_phase_function": [["np.ones(2)", "np.full(2, 1.5 + 0j)", "np.zeros(3)", "np.empty(6)"]], "_aureole.fresnel": [["np.ones(2)", "np.full(2, 1.5 + 0j)", "np.empty((5, 2), complex)", "np.empty((2, 2))"]],
    "_aureole.fresnel_diffuse_reflectance": [["np.ones(2)", "np.empty(2)"]], "_aureole.upsample": [["np.full((2, 3), 0.5)", "np.array([500.0])", "True", "False", "np.empty((2, 1))"]],
    "_aureole.polygon_aperture": [["np.array([0, 0, 1e-6, 0, 0, 1e-6])", "np.array([3])", "True"]], "_aureole.mask_aperture": [["np.eye(4, dtype=np.float32)", "1e-6", "True"]],
    "_aureole.hard_discs": [["np.ones(20)", "0.3", "1", "1.0", "1.0", "np.empty((2, 20, 2))"]], "_aureole.count_pairs": [["lattice()", "8.0", "8.0", "True", "np.array([0, 1.5, 3])", "2", "np.empty((4, 2))"]],
    "_aureole.ring_structure_factor": [["lattice()[None]", "8.0", "8.0", "np.array([0, 1.5, 3])", "5", "np.empty((3, 2))"]], "_aureole.window_structure_factor": [["lattice()[None]", "8.0", "8.0", "np.array([3, 5.0])", "np.empty((2, 2))"]],
    "_aureole.hard_disc_structure_factor": [["np.ones(2)", "np.full(2, 0.4)", "np.empty(2)"]], "_aureole.hard_disc_pair_correlation": [["np.ones(2)", "np.full(2, 0.4)", "np.empty(2)"]],
    "_aureole.lattice_factor": [["True", "0.4", "0.1", "4.0", "0.0", "True"]], "_aureole.tabulated_factor": [["np.array([1, 2.0])", "np.array([1, 2.0])"]],
    "_aureole.factor_of_pair_correlation": [["np.linspace(0, 10, 20)", "np.ones(20)", "0.4"]], "_aureole.refractive_index": [["'bk7'", "True", "np.array([500.0])", "np.empty(1, complex)"]],
    "_aureole.xyz_to_srgb": [["np.ones((2, 3))", "np.empty((2, 3))"]], "_aureole.render": [["scene()._open", "0", "4", "None", "1", "1", "0.0", "None", "None"]], "_aureole.StructureFactor.evaluate": [["np.ones(4)", "True", "np.empty(2)"]],
    "_aureole.srgb_encode": [["np.ones(2)", "np.empty(2)"]], "_aureole.srgb_decode": [["np.ones(2)", "np.empty(2)"]], "_aureole.load_object": [["XML", "'<text>'", "360.0", "830.0", "{}"]], "_aureole.simulated_factor": [["0.3", "200", "16", "1"]],
    "_aureole.check_bsdf": [["bsdf('diffuse')", "lossless=False", "reciprocal=True", "black_below=None", "may_fail=True", "radiance=False", "samples=1000", "significance=0.01", "tolerance=0.002", "largest_energy=1.0", "min_nm=360.0", "max_nm=830.0",
                              "index_ratio=None", "angles=[0.0, 45.0]", "most_bins=1000", "seed=1", "progress=None"]],
    "aureole.check": [["bsdf('diffuse')", "samples=1000"]], "aureole.load_string": [["XML"], ["torn_text(XML, R)"], ["'<bsdf type=\"diffuse\"/>'"]], "aureole.load_file": [["text_file(XML)", "n=5"], ["text_file(torn_text(XML, R))"]],
    "aureole.load_dict": [["SPHERES"], ["mutated(SPHERES, R)"], ["mutated(SPHERES, R)"], ["mutated({'type': 'blendbsdf', 'weight': 0.2, 'a': {'type': 'diffuse'}, 'b': {'type': 'plastic'}}, R)"]],
    "aureole.Scene.__setitem__": [["'glass.alpha'", "0.3"], ["'ball.bsdf'", "mutated({'type': 'diffuse'}, R)"], ["torn_text('lamp.emitter.radiance', R)", "2.0"], ["'mesh.vertices'", "np.ones((3, 3))"], ["'sensor.film.width'", "5"]],
    "aureole.Image.save": [["file('a.exr')"], ["file('a.png')", "1.0"], ["file('a.hdr')"], ["file('a.pfm')"], ["file('a.txt')"]], "aureole.read_image": [["file('a.exr')"], ["torn(file('a.exr'), R)"], ["torn(file('a.exr'), R)"]],
    "aureole.plot.spectrum": [["[400, 500, 600]", "[1, 2, 3]"]], "aureole.plot.phase_function": [["[0, 90, 180]", "[1, 2, 3]"], ["x=3", "m=1.5"]], "aureole.plot.structure_factor": [["[0, 1, 2]", "[1, 1, 1]", "0.1"]],
    "aureole.optics.PlaneStack": [["[optics.StackLayer(1, 0.1, 0.9, index=1.5, interface='ggx'), optics.StackLayer(2, 1)]", "streams=4", "substrate=0.5"]],
    "aureole.optics.PlaneStack.radiance": [["[0.5, -0.5]", "[0, 1]", "cosine=0.5"]], "aureole.optics.PlaneStack.fields": [["0", "[0, 1]"]], "aureole.optics.PlaneStack.fluxes": [["0.5"]],
    "aureole.optics.EdgeWaves": [["[[(0, 0), (1, 0)]]", "1.0", "sigma=1.0"]], "aureole.optics.EdgeWaves.polygon": [["[(0, 0), (1, 0), (0, 1)]", "sigma=1.0"]],
    "aureole.optics.triangle_transform": [["[(0, 0), (1, 0), (0, 1)]", "[1, 1, 1]", "[[0, 1]]"]], "aureole.optics.gaussian_beam_power": [["[(0, 0), (1, 0), (0, 1)]", "1.0"]],
    "aureole.optics.mean_edge_kernel": [["[[(0, 0), (1, 0)]]", "0", "0.5", "[1, 0]", "10.0", "1.0"]], "aureole.optics.radio_permittivity": [["'concrete'", "3.5e9"]],
    "aureole.optics.rayleigh_sommerfeld": [["[[0, 0, 3.0]]", "6.0", "radius=1.0"]], "aureole.optics.kirchhoff": [["[[0, 0, 3.0]]", "6.0", "polygons=[[(0, 0), (1, 0), (0, 1)]]"]],
    "aureole.optics.fraunhofer": [["[[0, 3.0]]", "radius=1.0"]], "aureole.optics.utd_field": [["1.0", "1.0", "6.0", "2.0"]], "aureole.optics.utd_coefficient": [["1.0", "1.0", "6.0", "2.0"]],
    "_aureole.triangle_transform": [["np.array([0, 0, 1.0, 0, 0, 1])", "np.ones(3, complex)", "np.ones(2)", "np.empty(1, complex)"]], "_aureole.fresnel_integral": [["np.ones(2)", "np.empty(2, complex)"]],
    "_aureole.knife_edge": [["np.ones(2)", "np.empty(2, complex)"]], "_aureole.transition_function": [["np.ones(2)", "np.empty(2, complex)"]], "_aureole.gaussian_beam_power": [["1.0", "np.array([0, 0, 1.0, 0, 0, 1])"]],
    "_aureole.wedge": [["2.0", "np.array([6, 1.0, 1, 1, 1])", "np.ones(2, complex)", "True", "np.empty(1, complex)"]], "_aureole.radio_permittivity": [["'wood'", "np.array([1e9])", "np.empty(1, complex)"]],
    "_aureole.mean_edge_kernel": [["np.array([0, 0, 1.0, 0, 1])", "0", "np.array([0.5, 1, 1, 6, 1])", "np.empty(1)"]], "_aureole.mean_edge_powers": [["np.array([0, 0, 1.0, 0, 1])", "0", "np.array([0.5, 6, 1])", "np.empty(1)"]],
    "_aureole.drawn_edge_kernels": [["np.array([0, 0, 1.0, 0.5, 1.2])", "0", "np.array([0.5, 1, 0.1, 6, 1])", "np.empty(1)"]], "_aureole.straight_edge_kernels": [["np.array([0.5, 0.1, 1, 6, 1])", "np.empty(1)"]],
    "_aureole.straight_edge_corrections": [["np.array([0.5, 0.1, 1, 0.5, 6, 1])", "np.empty(1)"]],
    "_aureole.straight_edge_power_correction": [["np.array([0.5, 1])", "np.empty(1)"]],
    "_aureole.straight_edge_weights": [["np.array([0, 0, 1.0, 0.5, 1.2])", "np.array([0, 1, 3, 2, 1.0])", "np.empty(1)"]], "_aureole.straight_edge_power": [["np.array([0.5, 6, 1])", "np.empty(1)"]], "_aureole.diffracted_intensity": [["np.ones(1, complex)", "np.array([1, 0, 6, 0.1])", "np.empty(1)"]], "_aureole.faddeeva": [["np.ones(2, complex)", "np.empty(2, complex)"]],
    "_aureole.triangle_power": [["np.array([0, 0, 1.0, 0, 0, 1])", "np.ones(3, complex)"]], "_aureole.amplitude_moments": [["np.array([0, 0, 1.0, 0, 0, 1])", "np.ones(3, complex)"]], "_aureole.zeroth_order_power": [["np.array([0, 0, 1.0, 0, 0, 1])", "np.ones(3, complex)", "1.0"]],
    "_aureole.edge_alpha1": [["np.ones(4)", "np.empty(2)"]], "_aureole.edge_alpha2": [["np.ones(4)", "np.empty(2)"]], "_aureole.keller_coefficient": [["2.0", "np.array([6, 1.0, 1, 0.5])", "True", "np.empty(1, complex)"]],
    "_aureole.plane_wave_distance": [["np.ones(4)", "np.empty(2)"]], "_aureole.point_source_distance": [["np.ones(6)", "np.empty(2)"]], "_aureole.plane_wave_spreading": [["np.ones(2)", "np.empty(2)"]], "_aureole.point_source_spreading": [["np.ones(4)", "np.empty(2)"]],
    "aureole.optics.triangle_power": [["[(0, 0), (1, 0), (0, 1)]", "[1, 1, 1]"]], "aureole.optics.amplitude_moments": [["[(0, 0), (1, 0), (0, 1)]", "[1, 1, 1]"]], "aureole.optics.zeroth_order_power": [["[(0, 0), (1, 0), (0, 1)]", "[1, 1, 1]", "1.0"]],
    "aureole.optics.interfering_power": [["[[(0, 0), (1, 0)]]", "1.0", "sigma=1.0"]], "aureole.optics.mean_edge_sigma": [["[[(0, 0), (1, 0)]]"]], "aureole.optics.edge_alpha1": [["[0.5, 1]", "1.0"]], "aureole.optics.edge_alpha2": [["[0.5, 1]", "1.0"]],
    "aureole.optics.mean_edge_powers": [["[[(0, 0), (1, 0)]]", "0", "0.5", "6.0", "1.0"]], "aureole.optics.drawn_edge_kernels": [["[[(0, 0), (1, 0.5)]]", "0", "[0.5, 1]", "0.1", "6.0", "1.0"]], "aureole.optics.straight_edge_kernels": [["0.5", "0.1", "6.0", "1.0"]],
    "aureole.optics.straight_edge_corrections": [["0.5", "0.1", "6.0", "1.0"]],
    "aureole.optics.straight_edge_power_correction": [["0.5", "1.0"]],
    "aureole.optics.straight_edge_weights": [["(0, 0)", "3.0", "2.0", "[[(0, 1), (1, 0.5)]]", "1.0"]], "aureole.optics.straight_edge_power": [["0.5", "6.0", "1.0"]], "aureole.optics.diffracted_intensity": [["1.0", "[1, 0]", "6.0", "0.1"]], "aureole.optics.faddeeva": [["1.0"]], "aureole.optics.keller_coefficient": [["1.0", "0.5", "6.0"]],
    "aureole.optics.plane_wave_distance": [["1.0"]], "aureole.optics.point_source_distance": [["1.0", "2.0"]], "aureole.optics.plane_wave_spreading": [["1.0"]], "aureole.optics.point_source_spreading": [["1.0", "2.0"]],
    "_aureole.diffraction_integral": [["'kirchhoff'", "np.array([0, 0, 1.0, 0, 0, 1])", "np.array([3])", "1.0", "0.0", "False", "[0, 0, 1.0]", "6.0", "np.array([0, 0, 2.0])", "np.empty(1, complex)"]],
    "_aureole.DiffractingEdges": [["np.array([0, 0, 1.0, 0])", "np.ones(2, complex)", "'beam'", "1.0"]], "_aureole.DiffractingEdges.field": [["np.ones(4)", "np.empty(2, complex)"]],
    "_aureole.DiffractingEdges.pdf": [["np.ones(4)", "np.empty(2)"]], "_aureole.DiffractingEdges.sample": [["1", "np.empty(4)"]],
    "aureole.optics.StructureFactor.table": [["[0, 1.0]", "[0.5, 1.0]"]], "aureole.optics.StructureFactor.at": [["[[0.5, 1]]"]], "aureole.spectrum.illuminant": [["'D65'", "[400, 500]"]],
    "aureole.spectrum.material": [["'bk7'"]], "aureole.spectrum.refractive_index": [["'bk7'", "[500, 600]"]], "aureole.Transform.__matmul__": [["aureole.Transform()"]], "aureole.plot.corona": [["radius='8um'", "area_fraction=0.5", "resolution=8"]],
    "aureole.spectrophotometer": [["bsdf('diffuse')", "paths=64", "step=200"]], "aureole.goniometer": [["bsdf('diffuse')", "paths=64", "step=200", "directions=9", "incident=[0, 30]"]],
    "aureole.goniometer_report": [["bsdf('diffuse')", "paths=64", "step=300"]], "aureole.lateral_spread": [["str(text_file(XML)) + '#grey'", "[0.001]"]],
    "aureole.spectroradiometer": [["'FL2'"], ["'FL2'", "pixels=32"]], "aureole.color": [["'#ff0000'"], ["'lab(50, 1, 2)'", "standard='#ffffff'"]], "aureole.cam16": [["(20, 20, 20)", "(95, 100, 109)"]],
    "aureole.convert_bsdf": [["bsdf('diffuse')", "str(FOLDER / f'{os.getpid()}.csv')", "step=200", "angles=3"]], "aureole.color_rendering": [["'FL2'"]],
    "_aureole.spectrum_file": [["str(FOLDER / f'{os.getpid()}.csv')", "[400.0, 500.0]", "[0.1, 0.2]", "'a'", "False", "'45a:0'"]], "_aureole.colours": [["['#ff0000']", "''", "'D65'", "[]", "(2.0, 1.0)"]],
    "aureole.layer": [["bsdf('roughdielectric')", "samples=64", "step=200"]], "aureole.medium": [["fog()", "step=200"]], "aureole.info": [["file('a.exr')"], ["torn(file('a.exr'), R)"], ["text_file(XML)"]],
    "aureole.compare": [["image()", "image()"], ["rendered()", "file('a.exr')"]], "aureole.rings": [["image()"], ["image()", "radius='3um'"]], "aureole.powermap": [["scene()", "4"], ["text_file(XML)", "4"]],
    "aureole.droplet_size": [["angles='2.5:max:G,3.5:min'", "lamp='550nm'"], ["image()", "fov=20"]], "_aureole.layer": [["bsdf('roughdielectric')", "0.0", "0.0", "200.0", "'D65'", "2.5", "64", "(0.5, 0.5)"]],
    "_aureole.medium": [["fog()", "200.0", "0.01", "(0, 0, 0)", "(0, 0, 1)"]], "_aureole.layer_of_file": [["str(text_file(XML)) + '#grey'", "[]", "0.0", "0.0", "200.0", "'D65'", "2.5", "64", "(0.5, 0.5)"]],
    "_aureole.compare_pictures": [["image()._picture", "rendered()._picture", "0", "2"]], "_aureole.file_info": [["file('a.exr')", "[]"], ["torn(file('a.exr'), R)", "[]"]],
    "_aureole.state_picture": [["file('a.exr')"]], "_aureole.grid_slice": [["file('a.exr')", "False", "2"]], "_aureole.splat_points": [["file('a.exr')", "100"]],
    "_aureole.measure_rings": [["image()._picture", "'a'", "[]", "[0, 360]", "[]", "30.0", "'D65'", "'5um'", "''", "0.5", "'0.5m'", "'14m'", "'36mm'", "0.25"]],
    "_aureole.power_maps": [["scene()._open", "image()._picture", "'2W'"]], "_aureole.PartSum": [["rendered()._picture"]], "_aureole.PartSum.add": [["_aureole.packed_part(rendered()._picture)", "0", "1", "[]"]],
    "_aureole.PartSum.check": [["_aureole.packed_part(rendered()._picture)", "0", "1"]], "_aureole.PartSum.unpacked": [["_aureole.packed_part(rendered()._picture)"], ["torn_bytes(_aureole.packed_part(rendered()._picture), R)"]],
    "_aureole.PartSum.resume": [["_aureole.PartSum(rendered()._picture).state()", "'a'"], ["torn_bytes(_aureole.PartSum(rendered()._picture).state(), R)", "'a'"]], "_aureole.packed_part": [["rendered()._picture"]],
    "_aureole.PartSum.same_samples": [["_aureole.packed_part(rendered()._picture)", "_aureole.packed_part(rendered()._picture)"]], "_aureole.empty_picture": [["scene()._open", "4", "None", "1", "None"]],
    "aureole.lens": [["text_file(LENS, 'lens')", "rays=4"], ["text_file(torn_text(LENS, R), 'lens')", "rays=4"]],
    "aureole.goniophotometer": [["text_file(LAMP, 'ies')"], ["text_file(torn_text(LAMP, R), 'ies')"], ["text_file(LAMP_SCENE)", "1", "c_step=90", "gamma_step=45", "progress=False"]],
    "aureole.illumination": [["text_file(OFFICE)", "1", "runs=2", "progress=False"]], "aureole.photometry": [["text_file(OFFICE)", "1", "progress=False"], ["aureole.load_string(OFFICE)", "1", "regions=[[0, 0, 1, 2]]", "progress=False"]],
    "aureole.expose": [["camera_scene()", "1", "exposure=0.01", "progress=False"], ["camera_scene()", "1", "exposure=0.01", "frames=2", "camera={'gain': 0.5}", "progress=False"]],
    "aureole.lightfield": [["field_scene()", "1", "progress=False"]], "_aureole.lens_figures": [["text_file(LENS, 'lens')", "None", "np.inf", "[0.0, 5.0]", "[550.0]", "4"]],
    "_aureole.load_goniophotometer": [["str(text_file(LAMP_SCENE))", "[]", "''", "1", "(90.0, 45.0)", "(0, 0, -1)", "[]"]], "_aureole.luminaire_of_file": [["text_file(torn_text(LAMP, R), 'ies')", "0", "(0, 0, 0)", "(0, 0, 0)", "[]"], ["text_file(LAMP, 'ies')", "0", "(0, 500, 0)", "(1, 1, 0)", "[('a', 'b')]"]],
    "_aureole.require_ugr_spacing": [["1.0"]], "_aureole.ugr_table": [["torn_text(LAMP.replace('2 0 0 0', '2 1 1 0'), R)", "'a.ies'", "1.0", "False"]],
    "aureole.ugr": [["text_file(LAMP, 'ies')", "spacing=1", "opening=(1, 1, 0)"], ["aureole.goniophotometer(text_file(LAMP, 'ies'), opening=(1, 1, 0))", "spacing=1"]],
    "_aureole.measured_luminaire": [["aureole.Image(np.ones((3, 4)))._picture", "'a.xml'", "''", "''", "1", "'none'", "(0, 0, 0)", "(0, 0, 0)"]],
    "_aureole.load_illumination": [["str(text_file(OFFICE))", "[]", "True"]], "_aureole.illumination_means": [["[rendered()._picture]", "'a'", "[]"], ["[rendered()._picture]", "'a'", "[[0, 0, 2, 2]]"]],
    "_aureole.photometric_map": [["rendered()._picture", "'a'"], ["aureole.render(aureole.load_string(OFFICE), 1, progress=False)._picture", "'a'"]], "_aureole.map_statistics": [["np.ones((2, 3))", "(0, 0, 2, 2)", "[]"], ["np.ones((1, 2))", "(0, 0, 2, 1)", "[1.0, 2.0]"]],
    "_aureole.cell_areas": [["scene()._open", "4", "4"], ["aureole.load_string(OFFICE)._open", "2", "2"]],
    "_aureole.picture_glare": [["np.ones((4, 6))", "'luminance'", "'cd/m^2'", "scene()._open", "(0, 1, 0)", "0.0"]], "_aureole.open_illuminance": [["scene()._open", "(0, 1, 0)"]],
    "_aureole.traced_solid_angle": [["scene()._open", "(0, 0, 5)", "(0, 0, -1)", "64"]], "_aureole.false_color_map": [["np.eye(4)", "'a'", "'b'", "None", "1.0", "False", "[]"]],
    "_aureole.light_field_axes": [["field_scene()._open"]], "_aureole.require_light_field": [["field_scene()._open"]],
    "_aureole.parsed_light_field": [["rendered()._picture", "torn_text('s, t: 2 x 2 views over 0.4 x 0.4; u, v: 3 x 2 pixels, width 3 at the distance 4', R)", "'a'"]],
    "_aureole.light_field_picture": [["rendered()._picture", "'s, t: 2 x 2 views over 0.4 x 0.4; u, v: 3 x 2 pixels, width 3 at the distance 4'", "'a'", "(0, 0)", "0.1", "3.0"]],
    "_aureole.write_light_field": [["rendered()._picture", "'a'", "file('a.exr')"]], "_aureole.camera_of_file": [["text_file('{\"gain\": 1}', 'json')"]], "_aureole.exposure_of_scene": [["camera_scene()._open"]],
    "_aureole.expose_picture": [["aureole.render(camera_scene(), 1, progress=False)._picture", "'a'", "'{}'", "'a.json'", "0.01", "(1, 1)", "1"], ["aureole.render(camera_scene(), 1, progress=False)._picture", "'a'", "torn_text('{\"efficiency\": {\"nm\": [400, 700], \"values\": [0.2, 0.4]}, \"gain\": 0.1}', R)", "'a.json'", "0.01", "(1, 1)", "1"]],
    "_aureole.sphere_solid_angles": [["np.ones((2, 7))", "np.empty((2, 2))"]], "_aureole.disc_solid_angles": [["np.arange(10.0)[None]", "np.empty((1, 2))"]], "_aureole.polygon_solid_angles": [["np.eye(3)", "np.array([[0, 0, 0, 1, 1, 1.0]])", "np.empty((1, 2))"]],
    "_aureole.mesopic_luminances": [["np.ones(2)", "np.ones(2)", "np.empty((2, 2))"]], "_aureole.unified_glare_rating": [["50.0", "np.ones((2, 3))"]],
    "aureole.optics.sphere_solid_angle": [["[0, 0, 2]", "1"], ["[0, 0, 2]", "1", "normal=[0, 1, 1]"]], "aureole.optics.disc_solid_angle": [["[0, 0, 2]", "[0, 0, 1]", "1", "normal=[0, 1, 1]"]],
    "aureole.optics.polygon_solid_angle": [["np.eye(3)", "normal=[0, 1, 1]"]], "aureole.optics.solid_angle": [["{'type': 'sphere', 'center': [0, 0, 3]}", "samples=64"], ["scene()", "[0, 0, 9]", "[0, 0, -1]", "samples=64"]],
    "aureole.optics.photons": [["1.0", "550"]], "aureole.optics.irradiance_of_radiance": [["1.0", "2.0"]], "aureole.optics.irradiance_of_intensity": [["1.0", "2.0", "0.5"]], "aureole.optics.intensity_of_radiance": [["1.0", "2.0"]],
    "aureole.optics.radiance_of_intensity": [["1.0", "2.0"]], "aureole.optics.exitance_of_radiance": [["1.0"]], "aureole.optics.radiance_of_exitance": [["1.0"]], "aureole.optics.radiance_of_irradiance": [["1.0"]], "aureole.optics.flux_of_intensity": [["1.0"]],
    "aureole.optics.etendue": [["1.0", "2.0"]], "aureole.optics.mesopic_luminance": [["0.1", "2"]], "aureole.optics.unified_glare_rating": [["50", "[1e4]", "0.01"]],
    "aureole.Scene.__getitem__": [["'glass.alpha'"], ["torn_text('lamp.emitter.radiance', R)"]], "aureole.Scene.__contains__": [["'glass.alpha'"]], "aureole.Scene.__delitem__": [["'glass.alpha'"]],
}
# Programs that take the process over, what only a subclass has, and what is not of the package.
SKIPPED = {"aureole.Problem", "aureole._aureole.Error", "aureole._aureole.SceneError"}
DUNDERS = {"__getitem__", "__setitem__", "__delitem__", "__contains__", "__iter__", "__len__", "__matmul__", "__call__", "__repr__", "__array__", "__init__", "__eq__", "__hash__", "__reduce_ex__", "__copy__", "__deepcopy__"}


def mutated(description, number):
    """A copy of nested dicts with a few entries replaced, removed, renamed or moved."""
    rng = random.Random(number)

    def copied(value):
        return {k: copied(v) for k, v in value.items()} if type(value) is dict else value

    result = copied(description)
    for _ in range(rng.choice([0, 1, 1, 1, 2, 3])):
        dicts = [result]
        for d in dicts:
            if len(dicts) < 100:  # one may contain itself
                dicts += [v for v in d.values() if type(v) is dict]
        where = rng.choice(dicts)
        if not where:
            continue
        key = rng.choice(list(where))
        action = rng.randrange(8)
        if action == 0:
            del where[key]
        elif action == 1:
            where[evaluate(rng.choice(["3", "None", "'\\0'", "'\\ud800'", "'x y'", "''", "'type'", "'id'", "'a.b'", "'<'", "'\\n'"]), number)] = where.pop(key)
        elif action == 2:
            where[key] = rng.choice(dicts)
        elif action == 3:
            where["extra"] = evaluate(rng.choice(WRONG), number)
        elif action == 4:
            where["type"] = rng.choice([n for _, n, *_ in _aureole.plugins()])
        elif action == 5 and isinstance(where[key], (int, float)):
            where[key] = evaluate(rng.choice(NUMBERS), number)
        else:
            where[key] = evaluate(rng.choice(WRONG), number)
    return result


def torn_text(text, number):
    """Text with characters or parts replaced, doubled or left out."""
    rng = random.Random(number)
    for _ in range(rng.choice([1, 1, 2, 5])):
        i, j = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        j = rng.choice([i, i + 1, j])
        text = text[:i] + rng.choice(["", text[i:j] * 2, "\0", "\ud800", "<", '"', "&", "]]>", "-1", "nan", "1e999", ".", "<!--" * 3, "é"]) + text[j:]
    return text


def torn(path, number):
    """A file with some bytes changed or cut off."""
    rng = random.Random(number)
    data = bytearray(path.read_bytes())
    for _ in range(rng.choice([0, 1, 3, 20])):
        data[rng.randrange(len(data))] = rng.choice([0, 1, 127, 128, 255])
    path.write_bytes(data[: rng.choice([len(data), rng.randrange(len(data) + 1)])])
    return path


# ---------------------------------------------------------------- what is called


def _parameters(function, owner):
    """Names of parameters: positional ones, and those given by keyword alone."""
    try:
        items = list(inspect.signature(function).parameters.values())
        items = [p for p in items if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]
        names = [(p.name, p.kind is p.KEYWORD_ONLY) for p in items]
    except (TypeError, ValueError):
        # Compiled: from the first line of the documentation, or the signature that nanobind keeps.
        text = (getattr(function, "__doc__", None) or "").split("\n")[0]
        inside = re.sub(r"\[[^\[\]]*(\[[^\[\]]*\][^\[\]]*)*\]", "", text)
        m = re.search(r"\((.*?)\)( ->|$)", inside)
        names, keyword = [], False
        for part in (m[1].split(",") if m else []):
            name = re.match(r"\s*\*?\s*(\w*)", part)[1]
            keyword |= part.strip() == "*"
            if re.match(r"^[A-Za-z_]\w*$", name) and (":" in part or "=" in part or name == "self"):
                names.append((name, keyword))
    return [(n, k) for i, (n, k) in enumerate(names) if not (i == 0 and n in ("self", "cls"))]


def targets():
    """(name, expression that is called with {0} for an object, parameters, objects) of everything callable."""
    found = []
    modules = {"aureole": aureole, "aureole.optics": optics, "aureole.spectrum": spectrum, "aureole.plot": plot, "_aureole": _aureole}
    seen = set()
    for prefix, module in modules.items():
        names = getattr(module, "__all__", None) or [n for n in dir(module) if not n.startswith("_")]
        for name in sorted(names):
            value, full = getattr(module, name), f"{prefix}.{name}"
            if inspect.ismodule(value) or not callable(value) or ("aureole." + full if prefix == "_aureole" else full) in SKIPPED:
                continue
            if isinstance(value, type):
                if value in seen:
                    continue
                seen.add(value)
                holds_data = hasattr(value, "__dataclass_fields__") or hasattr(value, "_fields") or issubclass(value, (enum.Enum, BaseException))
                if not holds_data:
                    found.append((full, full, _parameters(value, None), []))
                key = next((k for k in (full, "aureole." + full) if k in INSTANCES), None)
                for attribute in sorted(set(dir(value))):
                    if attribute.startswith("_") and attribute not in DUNDERS:
                        continue
                    if attribute in ("__init__", "__eq__", "__hash__", "severity") and (attribute != "__init__" or "_aureole" not in value.__module__):
                        continue
                    if any(attribute in vars(base) for base in value.__mro__ if base.__module__ in ("builtins", "enum") or base is object) and \
                            not any(attribute in vars(b) for b in value.__mro__ if b.__module__.startswith("aureole")):
                        continue
                    raw = inspect.getattr_static(value, attribute)
                    if isinstance(raw, (staticmethod, classmethod)) or (key is None and type(raw).__name__ == "nb_func"):
                        found.append((f"{full}.{attribute}", f"{full}.{attribute}", _parameters(getattr(value, attribute), value), []))
                    elif key is None:
                        continue
                    elif callable(raw):
                        found.append((f"{full}.{attribute}", "{0}." + attribute, _parameters(raw, value), INSTANCES[key]))
                    else:
                        found.append((f"{full}.{attribute}", f"access({{0}}, {attribute!r}, ", [], INSTANCES[key]))
            else:
                found.append((full, full, _parameters(value, None), []))
    return found


def access(instance, attribute, *value):
    """Reads a property, or tries to write it."""
    if value:
        return setattr(instance, attribute, value[0])
    return getattr(instance, attribute)


def case(number, seed, all_targets):
    """Name of the target, the expression of it, and those of its arguments."""
    if "AUREOLE_FUZZ_INSTEAD" in os.environ:  # the test of the fuzzer itself
        return "aureole.render", f"(lambda: {json.loads(os.environ['AUREOLE_FUZZ_INSTEAD'])[number]})", []
    rng = random.Random(f"{seed}:{number}")
    name, call, parameters, objects = all_targets[number % len(all_targets)]
    key = name if not name.startswith("aureole._aureole") else name[8:]
    private = key.startswith("_aureole")
    # The buffer that numpy's dates give crashes nanobind's reader; Python code of the package never hands one on.
    wrong = [w for w in WRONG if "datetime" not in w] if private else WRONG
    if key in EXAMPLES and rng.random() < 0.8:
        arguments = list(rng.choice(EXAMPLES[key]))
        given = {p for p, _ in parameters[:len([a for a in arguments if not re.match(r"\w+=", a)])]}
        for p, _ in parameters:
            if p not in given and p in VALID and VALID[p] and rng.random() < 0.25 and not any(a.startswith(p + "=") for a in arguments) and not private:
                arguments.append(f"{p}={rng.choice(VALID[p])}")
    else:
        arguments = []
        for p, keyword in parameters:
            if keyword and rng.random() < 0.6 and not private:
                continue
            value = rng.choice(VALID.get(p) or wrong)
            arguments.append(f"{p}={value}" if keyword or any("=" in a and re.match(r"\w+=", a) for a in arguments) else value)
    for _ in range(rng.choice([0, 1, 1, 1, 1, 2, 2])):
        if not arguments:
            break
        k = rng.randrange(len(arguments))
        label = re.match(r"(\w+=)?", arguments[k])[0]
        pool = rng.choice([wrong, wrong, NUMBERS, ARRAYS])
        action = rng.random()
        if action < 0.75:
            arguments[k] = label + rng.choice(pool)
        elif action < 0.85 and arguments[k][len(label):].lstrip("-")[:1] in "0123456789[(n":
            arguments[k] = label + rng.choice(["np.asarray({})[..., None]", "np.asarray({}, '>f8')", "np.asarray({}).T", "np.asarray({}, 'f2')", "[{}]", "str({})", "np.broadcast_to({}, (3, 1) + np.shape({}))",
                                               "np.asarray({}) * 1e200", "-np.asarray({})", "np.asarray({}) * np.nan", "np.asarray({})[::-1]", "np.asarray({}) + 0j"]).replace("{}", arguments[k][len(label):])
        elif action < 0.92:
            arguments.pop(k)
        else:
            arguments.append(f"{rng.choice(['extra', 'seed', 'ax', 'uv'])}={rng.choice(wrong)}")
    if not parameters and not name.endswith("__") and rng.random() < 0.3:
        arguments.append(rng.choice(wrong))
    if call.endswith(", "):
        call = call[:-2]
        instance = rng.choice(objects)
        return name, "access", [instance, repr(call.split("'")[1])] + (arguments if rng.random() < 0.3 else [])
    if objects:
        return name, "(" + rng.choice(objects) + ")" + call[3:], arguments
    return name, call, arguments


_NAMES = globals()


def evaluate(expression, number):
    return eval(expression, _NAMES, {"R": number})  # noqa: S307


# ---------------------------------------------------------------- one case


def _alarm(*_):
    raise Mine("interrupted")


_PYTHONS = ("positional argument", "unexpected keyword", "required argument", "keyword argument", "multiple values for", "takes no arguments", "unhashable", "no constructor defined", "needs the methods", "class methods", "expected an instance of the class", "incompatible function arguments")


def verdict(name, parameters, named, error):
    """The fault of an exception; an empty string if it is a proper one."""
    if isinstance(error, (Mine, aureole.Error, MemoryError, ImportError)):
        text = str(error)
        return "message" if isinstance(error, aureole.Error) and (not text.strip() or "std::" in text or "vector::" in text) else ""
    private = "_aureole" in name
    if name.endswith("__init__") and private and isinstance(error, (RuntimeError, TypeError)):
        return ""
    if isinstance(error, NotImplementedError) or (isinstance(error, AttributeError) and re.search("setter|can't set|read-only|not writable|cannot assign|no attribute|immutable", str(error)) and "access" in str(getattr(error, "where", ""))):
        return ""
    if isinstance(error, (TypeError, ValueError, KeyError, IndexError)) and not isinstance(error, UnicodeError):
        text = str(error)
        if private or isinstance(error, (KeyError, IndexError)):
            return ""
        known = {p for p, _ in parameters} | {"matrix", "transform", "path", "instance", "unhashable", "subscript", "data type", "dtype", "Lambert"} | set(named)
        if any(re.search(rf"\b{re.escape(k)}\b", text) for k in known) or any(p in text for p in _PYTHONS[:-1]):
            return ""
        if "incompatible function arguments" in text and private:
            return ""
        return "message"
    return "exception"


def run_case(number, seed, all_targets):
    """(class of the failure or an empty string, what happened)."""
    name, call, arguments = case(number, seed, all_targets)
    parameters = next(t[2] for t in all_targets if t[0] == name)
    given, named = [], {}
    try:
        for a in arguments:
            m = re.match(r"(\w+)=(?!=)(.*)", a, re.DOTALL)
            if m:
                named[m[1]] = evaluate(m[2], number)
            else:
                given.append(evaluate(a, number))
        function = evaluate(call, number)
    except Exception as e:  # the case itself is not possible
        return ("", "impossible") if not isinstance(e, (SystemError, RecursionError)) else ("exception", f"{type(e).__name__}: {e}"[:500])
    signal.setitimer(signal.ITIMER_REAL, SOFT_S, 0.5)
    try:
        result = function(*given, **named)
        if inspect.isgenerator(result):
            for _ in zip(range(3), result):
                pass
        outcome = "result"
        if isinstance(result, np.ndarray) and result.size < 10000:
            result.copy()
        else:
            repr(result)[:100]
        return "", outcome
    except Exception as e:
        if call == "access":
            try:
                e.where = "access"
            except AttributeError:
                pass
        bad = verdict(name, parameters, named, e)
        try:
            text = str(e)
        except Exception:
            text = "?"
        return bad, f"{type(e).__name__}: {text[:300]}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close("all")


def source(number, seed, all_targets):
    _, call, arguments = case(number, seed, all_targets)
    return f"R = {number}; {call}({', '.join(arguments)})"


# ---------------------------------------------------------------- children and their parent


def child(seed, first, last):
    faulthandler.enable()
    signal.signal(signal.SIGALRM, _alarm)
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    warnings.simplefilter("ignore")
    sys.unraisablehook = lambda *_: None
    out = os.fdopen(os.dup(1), "w", buffering=1)
    null = os.open(os.devnull, os.O_RDWR)
    os.dup2(null, 0), os.dup2(null, 1)
    FOLDER.mkdir(exist_ok=True)
    os.chdir(FOLDER)
    all_targets = targets()
    if "AUREOLE_FUZZ_INSTEAD" not in os.environ:
        try:
            import matplotlib.pyplot  # noqa: F401, not amid a case, which may be interrupted
        except ImportError:
            pass
    for number in range(first, last):
        out.write(f"{number}\n")
        bad, what = "exception", "?"
        try:
            bad, what = run_case(number, seed, all_targets)
        except Mine:  # the alarm, between the lines
            bad, what = "", "interrupted"
        except BaseException as e:  # noqa: BLE001
            bad, what = "exception", f"{type(e).__name__}: {e}"
        out.write(json.dumps([number, bad, what]) + "\n")
    out.write("end\n")


def _cpu_s(pid):
    try:
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, IndexError):
        return 0.0


class _Batch:
    """A child at work on a range of cases, replaced by another one where it ends too early."""

    def __init__(self, seed, first, last):
        self.seed, self.next, self.last = seed, first, last
        self.first = first
        self.results, self.current = [], None
        self.start()

    def start(self):
        self.errors = tempfile.TemporaryFile()
        self.started = self.next
        self.process = subprocess.Popen([sys.executable, "-X", "faulthandler", os.path.abspath(__file__), "--child", str(self.seed), str(self.next), str(self.last)],
                                        stdout=subprocess.PIPE, stderr=self.errors, env={**os.environ, "MPLBACKEND": "Agg"})
        os.set_blocking(self.process.stdout.fileno(), False)
        self.buffer, self.done = b"", False
        self.since, self.cpu = time.monotonic(), 0.0

    def read(self):
        """Takes what has come; False when all is done."""
        data = self.process.stdout.read()
        if data:
            self.buffer += data
            *lines, self.buffer = self.buffer.split(b"\n")
            for line in lines:
                if line == b"end":
                    self.done = True
                elif line.startswith(b"["):
                    number, bad, what = json.loads(line)
                    self.results.append((number, bad, what))
                    self.next, self.current = number + 1, None
                else:
                    self.current = int(line)
                    self.since, self.cpu = time.monotonic(), _cpu_s(self.process.pid)
        wall, cpu = time.monotonic() - self.since, _cpu_s(self.process.pid) - self.cpu
        hangs = self.current is not None and ((wall > SOFT_S + HARD_S and cpu > HARD_S) or wall > 6 * (SOFT_S + HARD_S))
        if hangs:
            self.process.send_signal(signal.SIGABRT)  # faulthandler says where
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
        code = self.process.poll()
        if code is None or (data and not hangs):
            return True
        self.process.wait()
        self.process.stdout.close()
        self.errors.seek(0)
        text = self.errors.read().decode(errors="replace")[-3000:]
        self.errors.close()
        if "nanobind: leaked" in text:
            self.results.append((self.started, "leak", text))
        if self.done and code == 0:
            return False
        if self.current is None and not self.done:
            self.results.append((self.next, "crash", f"before a case, exit code {code}\n{text}"))
            return False
        if self.done:
            self.results.append((self.started, "crash", f"at exit of the process that ran {self.started} to {self.last}, exit code {code}\n{text}"))
            return False
        self.results.append((self.current, "hang" if hangs else "crash", f"exit code {code} in the process that had begun with case {self.started}\n{text}"))
        self.next, self.current = self.current + 1, None
        if self.next >= self.last:
            return False
        self.start()
        return True


def run(cases, seed, jobs, first=0, batch=400, note=lambda *_: None):
    """Results (case, class of failure or "", what happened) of all cases."""
    ranges = [(a, min(a + batch, first + cases)) for a in range(first, first + cases, batch)]
    running, results = [], []
    while ranges or running:
        while ranges and len(running) < jobs:
            running.append(_Batch(seed, *ranges.pop(0)))
        select.select([b.process.stdout for b in running], [], [], 0.2)
        for b in list(running):
            if not b.read():
                running.remove(b)
                results += b.results
                note(len(results))
    return sorted(results)


def failures_text(results, seed):
    """The failures, one of a kind, with Python that shows them."""
    all_targets, seen, lines = targets(), collections.Counter(), []
    for number, bad, what in results:
        if not bad:
            continue
        name = all_targets[number % len(all_targets)][0]
        kind = (bad, name, re.sub(r"[\d.]+|'.*?'", "#", what)[:60])
        seen[kind] += 1
        if seen[kind] == 1:
            lines.append(f"{bad}: {name}, case {number}: {what}\n    from fuzz_bindings import *; {source(number, seed, all_targets)[:600]}")
    return lines


def main():
    if sys.argv[1:2] == ["--child"]:
        return child(int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--list", action="store_true", help="print what is called, and end")
    parser.add_argument("--show", action="store_true", help="print the cases and what happened")
    arguments = parser.parse_args()
    if arguments.list:
        for name, _, parameters, _ in targets():
            print(name, *(p for p, _ in parameters))
        return 0
    start = time.monotonic()
    results = run(arguments.cases, arguments.seed, arguments.jobs, arguments.first)
    if arguments.show:
        all_targets = targets()
        for number, bad, what in results:
            print(f"{number} {bad or 'ok'} {source(number, arguments.seed, all_targets)[:300]}\n    {what[:300]}")
    lines = failures_text(results, arguments.seed)
    print("\n".join(lines))
    outcomes = collections.Counter("result" if w in ("result", "impossible") else w.split(":")[0] for _, b, w in results if not b)
    print(f"{len(results)} cases, {sum(bool(b) for _, b, _ in results)} failures of {len(lines)} kinds, {time.monotonic() - start:.0f} s; {dict(outcomes.most_common(12))}")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
