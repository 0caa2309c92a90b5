# SPDX-License-Identifier: Apache-2.0
"""Shapes of openings, with the names and parameters of the aperture plug-ins. See `aureole.optics`."""
from __future__ import annotations

import math
from typing import Any, List, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import integer, real, scalar
from ._aureole import ApertureShape
from ._errors import Error
from ._vectorised import last_axis


def circle(radius: float) -> ApertureShape:
    """A circle about the origin; its transform is Airy's, area 2 J1(u)/u with u = |q| radius.

    Parameters
    ----------
    radius : float
        In m, from 1 nm to 1 m.

    References
    ----------
    Born & Wolf, Principles of Optics, 7th ed. 1999, section 8.5.2.

    Examples
    --------
    >>> from aureole import optics
    >>> drop = optics.circle(5e-6)
    >>> (drop.transform([[0, 0], [3.8317 / 5e-6, 0]]) / drop.area).real.round(4)
    array([1., 0.])
    """
    r = _length("radius", radius)
    return _aureole.ellipse_aperture(r, r)


def ellipse(radius_x: float, radius_y: float) -> ApertureShape:
    """An ellipse about the origin, its semi-axes along x and y in m, from 1 nm to 1 m."""
    return _aureole.ellipse_aperture(_length("radius_x", radius_x), _length("radius_y", radius_y))


def annulus(radius: float, inner_radius: float) -> ApertureShape:
    """The ring between two circles about the origin, radii in m, from 1 nm to 1 m.

    `inner_radius` must be smaller than `radius` by at least a millionth of it.
    """
    outer, inner = _length("radius", radius), _length("inner_radius", inner_radius)
    if not inner <= 0.999999 * outer:
        raise Error(f"inner_radius: expected less than radius, {outer:g} m, by a millionth at least, got {inner:g}")
    return _aureole.annulus_aperture(outer, inner)


def ngon(radius: float, sides: int = 6) -> ApertureShape:
    """A regular polygon with a corner on the y axis.

    Parameters
    ----------
    radius : float
        Distance of the corners from the centre in m, from 1 nm to 1 m.
    sides : int
        3 to 1000.
    """
    r, n = _length("radius", radius), integer("sides", sides, minimum=3, maximum=1000)
    return _polygon([_around([r] * n)], False)


def rectangle(width: float, height: float) -> ApertureShape:
    """A rectangle about the origin with sides along x (`width`) and y (`height`) in m, from 1 nm to 1 m.

    The sides may differ by a factor of a million.
    """
    x, y = 0.5 * _length("width", width), 0.5 * _length("height", height)
    if not (x <= 1e6 * y and y <= 1e6 * x):
        raise Error(f"height: expected sides that differ by a factor of a million at most, got {2 * x:g} x {2 * y:g}")
    return _polygon([np.array([[-x, -y], [x, -y], [x, y], [-x, y]])], False)


def star(radius: float, points: int = 5, inner_ratio: float = 0.5) -> ApertureShape:
    """A regular star with a point on the y axis.

    Parameters
    ----------
    radius : float
        Distance of the points from the centre in m, from 1 nm to 1 m.
    points : int
        3 to 1000.
    inner_ratio : float
        Distance of the inner corners relative to `radius`, in [0.001, 1].
    """
    r, n = _length("radius", radius), integer("points", points, minimum=3, maximum=1000)
    inner = scalar("inner_ratio", inner_ratio, minimum=0.001, maximum=1)
    return _polygon([_around([r, r * inner] * n)], False)


def polygon(vertices: npt.ArrayLike, holes: Sequence[npt.ArrayLike] = (), *, centroid: bool = True) -> ApertureShape:
    """A shape with straight edges.

    Parameters
    ----------
    vertices : array_like, shape (n, 2)
        Corners in m, in either order. The edges must not touch or cross.
    holes : sequence of array_like, shape (k, 2)
        Parts inside that are not open; they must not overlap.
    centroid : bool
        The centroid becomes the origin; otherwise the origin of the vertices is kept. (An origin elsewhere multiplies
        the transform by a phase.)

    Notes
    -----
    At most 10000 vertices; between 1 nm and 1 m in size. The transform follows Lee & Mittra, "Fourier transform of a
    polygonal shape function and its application in electromagnetics", 1983, with an error of 1e-12 of the area.

    Examples
    --------
    >>> from aureole import optics
    >>> frame = optics.polygon([(0, 0), (4e-6, 0), (4e-6, 4e-6), (0, 4e-6)],
    ...                        holes=[[(1e-6, 1e-6), (3e-6, 1e-6), (3e-6, 3e-6), (1e-6, 3e-6)]])
    >>> round(frame.area * 1e12, 9)
    12.0
    """
    outer = _ring("vertices", vertices)
    if isinstance(holes, np.ndarray) and holes.ndim == 2:
        raise Error(f"holes: expected a sequence of arrays of shape (k, 2), got one of shape {holes.shape}")
    try:
        inner = [_ring(f"holes[{i}]", hole) for i, hole in enumerate(holes)]
    except (TypeError, ValueError) as e:  # ValueError: a closed file, for instance
        if "holes[" in str(e):
            raise
        raise TypeError(f"holes: expected a sequence of arrays of shape (k, 2), got {type(holes).__name__}") from None
    shape = _polygon([outer, *inner], _flag("centroid", centroid))
    expected = abs(_signed_area(outer)) - sum(abs(_signed_area(ring)) for ring in inner)
    if abs(shape.area - expected) > 1e-6 * abs(_signed_area(outer)):
        raise Error("holes: expected rings inside of the outer one that do not overlap")
    if not 1e-9 <= shape.bounding_radius <= 1:
        raise Error("vertices: expected a shape that reaches 1 nm to 1 m from its origin, got "
                    f"{shape.bounding_radius:g} m")
    return shape


def mask(open: npt.ArrayLike, pixel_size: float, *, centroid: bool = True) -> ApertureShape:
    """A shape given by a picture, such as a micrograph after thresholding.

    Parameters
    ----------
    open : array_like, shape (rows, columns)
        Transmittance of square pixels in [0, 1], or booleans; rows from the top (largest y) downwards. At most 2^25
        pixels. A border of zeros is cut off; a picture that is still wider or higher than 1024 is averaged over
        squares of pixels.
    pixel_size : float
        Side of a pixel in m; the shape may be 1 nm to 1 m large.
    centroid : bool
        The centroid becomes the origin; otherwise the centre of the picture is the origin.

    Notes
    -----
    Up to |q_x|, |q_y| < pi/pixel_size the transform is the shape's, to 1e-4 of the area; beyond, it is the transform
    of the square pixels.

    Examples
    --------
    >>> import numpy as np
    >>> from aureole import optics
    >>> y, x = np.mgrid[-50:51, -50:51]
    >>> disc = optics.mask(x**2 + y**2 < 40**2, 1e-7)
    >>> round(disc.radius * 1e6, 2)
    3.99
    """
    values = np.asarray(open)
    if values.dtype == np.bool_ and not np.ma.is_masked(open):
        values = values.astype(np.float32)
    else:
        values = real("open", open, minimum=0, maximum=1)
    if values.ndim != 2 or values.size == 0:
        raise Error(f"open: expected an array of shape (rows, columns), got shape {values.shape}")
    if values.size > 2**25:
        raise Error(f"open: expected at most 2^25 pixels, got {values.size}")
    pixel = scalar("pixel_size", pixel_size, positive=True)
    shape = _aureole.mask_aperture(np.ascontiguousarray(values, np.float32), min(max(pixel, 1e-15), 1.0),
                                   _flag("centroid", centroid))
    if not (1e-15 <= pixel <= 1 and 1e-9 <= shape.bounding_radius <= 1):
        raise Error(f"pixel_size: expected a shape that reaches 1 nm to 1 m from its origin, got pixels of {pixel:g} m")
    return shape


def _length(name: str, value: Any) -> float:
    return scalar(name, value, minimum=1e-9, maximum=1.0, unit="m")


def _flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: expected True or False, got {type(value).__name__}")
    return bool(value)


def _around(radii: Union[List[float], Tuple[float, ...]]) -> npt.NDArray[np.float64]:
    """Returns corners at equal angles, counter-clockwise from the y axis."""
    angles = [math.pi * (0.5 + 2 * i / len(radii)) for i in range(len(radii))]
    return np.array([[r * math.cos(a), r * math.sin(a)] for r, a in zip(radii, angles)])


def _ring(name: str, vertices: Any) -> npt.NDArray[np.float64]:
    ring = real(name, vertices)
    last_axis(name, ring, 2)
    if ring.ndim != 2 or len(ring) < 3:
        raise Error(f"{name}: expected an array of shape (n, 2) with n of 3 or more, got shape {ring.shape}")
    return ring


def _signed_area(ring: npt.NDArray[np.float64]) -> float:
    x, y = (ring - ring.mean(axis=0)).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _polygon(rings: Sequence[npt.NDArray[np.float64]], centroid: bool) -> ApertureShape:
    flat = np.ascontiguousarray(np.concatenate(rings)).reshape(-1)
    return _aureole.polygon_aperture(flat, np.array([len(ring) for ring in rings], np.int64), centroid)
