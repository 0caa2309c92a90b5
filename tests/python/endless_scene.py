# SPDX-License-Identifier: Apache-2.0
"""A small scene and what programs that test_robustness.py starts want beside it. It imports no pytest, which takes as long as such a program."""
import gc
import multiprocessing
import os
import signal
import sys
import threading
import time

import numpy as np

import aureole
from aureole import optics

__all__ = ["Lambert", "make", "ENDLESS", "gc", "multiprocessing", "os", "signal", "sys", "threading", "time", "np", "aureole", "optics"]


class Lambert:
    """A BSDF written in Python."""

    lobes = ("diffuse", "reflect")

    def eval(self, wi, wo, wavelength):
        return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), wo[:, 2] / np.pi, 0)

    def pdf(self, wi, wo, wavelength):
        return self.eval(wi, wo, wavelength)

    def sample(self, wi, wavelength, u):
        r, phi = np.sqrt(u[:, 1]), 2 * np.pi * u[:, 2]
        wo = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 1])], -1)
        return wo, self.eval(wi, wo, wavelength), self.pdf(wi, wo, wavelength)


def make(spp=16, size=16, bsdf=None, **more):
    return aureole.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 4},
        "sensor": {"type": "perspective", "fov": 40.0, "to_world": aureole.Transform.look_at([0, 0, 5], [0, 0, 0]),
                   "film": {"type": "hdrfilm", "width": size, "height": size}, "sampler": {"type": "independent", "sample_count": spp}},
        "ball": {"type": "sphere", "bsdf": {"type": "roughconductor", "alpha": 0.2} if bsdf is None else bsdf},
        "sky": {"type": "constant", "radiance": 1.0}, **more})


ENDLESS = 2**22  # samples that no test waits for
