# SPDX-License-Identifier: Apache-2.0
"""`denoise`: noise of pictures removed by Intel Open Image Denoise, which the package `pyoidn` brings."""

from __future__ import annotations

import importlib
import xml.etree.ElementTree as ElementTree
from typing import TYPE_CHECKING, Any, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._arrays import flag, integer, shown, text
from ._errors import Error
from ._image import Image, _bin_wavelength
from ._scene import Scene, load_string

if TYPE_CHECKING:
    from ._bars import Report

Floats = npt.NDArray[np.float32]
_WINDOW = 3  # half the side, in pixels, of the windows in which noise and bias are measured


def denoise(
    image: Image,
    *,
    scene: Optional[Scene] = None,
    albedo: Any = None,
    normal: Any = None,
    feature_samples: int = 32,
    quality: str = "high",
    keep_clean: bool = True,
    progress: "Union[bool, Report]" = False,
) -> Image:
    """Removes noise from a rendered picture by Open Image Denoise (`pip install aureole[denoise]`).

    Parameters
    ----------
    image : Image
        With R, G and B, Y, or spectral bins, in linear values. Render it with a box filter: wider filters give neighbours the same noise,
        which the network takes for structure. With a variance (``replicates`` of `render`) clean pixels stay as they are.
    scene : Scene, optional
        The scene of the picture: albedos and normals of the first surfaces that are no mirrors or glass are rendered and guide the network.
    albedo, normal : array_like of shape (height, width, 3), optional
        Such features, noise-free, instead of `scene`. Without either, the layers "albedo" and "normal" of the picture guide the network, which
        ``render(..., denoise=True)`` and ``aureole render --denoise`` write.
    feature_samples : int
        Samples per pixel of the features of `scene`.
    quality : {"high", "balanced", "fast"}
    keep_clean : bool
        With a variance v of the picture and an estimate b^2 of the squared bias of the network's picture, both over windows of 7 x 7 pixels, the
        result is the mean of the two pictures with weights b^2 and v, which has the least expected squared error.
    progress
        Of the features, as for `render`.

    Returns
    -------
    Image
        The channels of the picture without noise, and the noisy ones as the layer "noisy". Spectral bins are treated in groups of three neighbours.

    References
    ----------
    Afra, "Intel Open Image Denoise", 2019 to 2026. Weights: Zheng, Zhang & Wang, "Ensemble denoising for Monte Carlo renderings", 2021.
    """
    oidn = network()
    if not isinstance(image, Image):
        raise TypeError(f"image: expected an Image, got {type(image).__name__}")
    if text("quality", quality) not in ("high", "balanced", "fast"):
        raise Error(f'quality: expected "high", "balanced" or "fast", got {shown(quality)}')
    if any(c.startswith("noisy.") for c in image.channels):
        raise Error('image: is denoised already: it has the layer "noisy"')
    groups = _groups(image)
    flag("keep_clean", keep_clean)
    if scene is not None:
        if albedo is not None or normal is not None:
            raise Error("scene: expected either a scene or albedo and normal")
        albedo, normal = features(scene, integer("feature_samples", feature_samples, minimum=1, maximum=2**20), progress=progress)
        albedo, normal = _prefiltered(oidn, albedo, normal, quality)
    elif albedo is None and normal is None and (own := _own_features(image)) is not None:
        albedo, normal = _prefiltered(oidn, *own, quality)
    guides = {}
    for name, given in (("albedo", albedo), ("normal", normal)):
        if given is not None:
            guides[name] = _guide(name, given, image)
    if "normal" in guides and "albedo" not in guides:
        raise Error("normal: the network takes normals with an albedo only")
    if "albedo" in guides:
        guides["albedo"] = np.clip(guides["albedo"], 0, 1)
    cleaned = np.array(image.array)
    variance = image.variance
    for group in groups:
        noisy = np.stack([image.array[..., c] for c in group], axis=-1)
        finite = np.nan_to_num(np.maximum(noisy, 0), nan=0.0, posinf=0.0).astype(np.float32)
        smooth = oidn.denoise(np.ascontiguousarray(finite), **guides, hdr=True, clean_aux=bool(guides), quality=quality)
        if keep_clean and variance is not None:
            smooth = _mixed(noisy, smooth, np.stack([variance[..., c] for c in group], axis=-1))
        for k, c in enumerate(group):
            cleaned[..., c] = smooth[..., k]
    used = sorted({c for group in groups for c in group})
    names = [*image.channels, *(f"noisy.{image.channels[c]}" for c in used)]
    pixels = np.ascontiguousarray(np.concatenate([cleaned, image.array[..., used]], axis=-1), dtype=np.float32)
    return Image._of(image._picture.edited(pixels, names, f"denoised by Open Image Denoise, quality {quality}"), image._outcome)


def network() -> Any:
    """The module of Open Image Denoise; an Error where it is missing."""
    try:
        return importlib.import_module("pyoidn")
    except (ImportError, OSError) as e:
        raise Error(f"denoising needs Open Image Denoise: pip install pyoidn ({e})") from None


def _own_features(image: Image) -> Optional[Tuple[Floats, Floats]]:
    """The layers albedo and normal of a picture that was rendered for denoising; None where it has none."""
    albedo, normal = ["albedo.R", "albedo.G", "albedo.B"], ["normal.X", "normal.Y", "normal.Z"]
    if not all(c in image.channels for c in (*albedo, *normal)):
        return None
    finite = [np.ascontiguousarray(np.nan_to_num(image[c]), dtype=np.float32) for c in (albedo, normal)]
    return finite[0], finite[1]


def _prefiltered(oidn: Any, albedo: Floats, normal: Floats, quality: str) -> Tuple[Floats, Floats]:
    """Features without their own noise, which mirrors and glass give them and which the network would take for structure."""
    clean = oidn.denoise(np.clip(albedo, 0, 1), hdr=False, clean_aux=False, quality=quality)
    turned = oidn.denoise(np.ascontiguousarray(0.5 * normal + 0.5, dtype=np.float32), hdr=False, clean_aux=False, quality=quality)
    return clean, np.ascontiguousarray(2 * turned - 1, dtype=np.float32)


def features(scene: Scene, samples: int = 32, *, progress: "Union[bool, Report]" = False) -> Tuple[Floats, Floats]:
    """Albedo and shading normal of the first surface in each pixel that is no mirror or glass, both of shape (height, width, 3): zero where there is none."""
    from ._render import render

    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene (from load_file, load_string or load_dict), got {type(scene).__name__}")
    root = ElementTree.fromstring(scene.xml())
    for old in root.findall("integrator"):
        root.remove(old)
    integrator = ElementTree.SubElement(root, "integrator", type="aov")
    ElementTree.SubElement(integrator, "string", name="aovs", value="albedo:albedo, normal:sh_normal")
    ElementTree.SubElement(integrator, "integer", name="specular_depth", value="8")
    set_box_filter(root)
    image = render(load_string(ElementTree.tostring(root, encoding="unicode")), samples, progress=progress)
    albedo = image[["albedo.R", "albedo.G", "albedo.B"]]
    normal = image[["normal.X", "normal.Y", "normal.Z"]]
    return np.ascontiguousarray(albedo), np.ascontiguousarray(normal)


def set_box_filter(root: ElementTree.Element) -> None:
    """Gives all films of a scene's XML a box filter."""
    for film in root.iter("film"):
        for old in film.findall("rfilter"):
            film.remove(old)
        ElementTree.SubElement(film, "rfilter", type="box")


def _groups(image: Image) -> List[Tuple[int, int, int]]:
    """Channels that are denoised together, three by three."""
    names = image.channels
    groups: List[Tuple[int, int, int]] = []
    if all(c in names for c in "RGB"):
        groups.append((names.index("R"), names.index("G"), names.index("B")))
    elif "Y" in names:
        groups.append((names.index("Y"),) * 3)
    bins = sorted((nm, i) for i, name in enumerate(names) if (nm := _bin_wavelength(name)) is not None)
    order = [i for _, i in bins]
    for begin in range(0, len(order), 3):
        part = order[begin : begin + 3]
        if len(part) < 3:  # the last ones with the neighbours before them
            part = (order[max(0, len(order) - 3) :] * 3)[:3]
        groups.append((part[0], part[1], part[2]))
    if not groups:
        raise Error(f"image: expected channels R, G and B, Y, or spectral bins, got {', '.join(names[:8])}")
    return groups


def _guide(name: str, given: Any, image: Image) -> Floats:
    try:
        array = np.ascontiguousarray(np.nan_to_num(np.asarray(given, dtype=np.float32)))
    except (TypeError, ValueError) as e:
        raise TypeError(f"{name}: expected an array of real numbers, got {type(given).__name__}") from e
    if array.shape != (image.height, image.width, 3):
        raise Error(f"{name}: expected the shape {(image.height, image.width, 3)} of the picture, got {array.shape}")
    return array


def _mixed(noisy: Floats, smooth: Floats, variance: Floats) -> Floats:
    """The mean of both pictures with the weights of least squared error; one weight for all channels of a group, so that hues stay."""
    scale = np.mean(np.nan_to_num(noisy), axis=(0, 1)) + 1e-30
    v = _window_mean(np.sum(np.nan_to_num(variance) / scale**2, axis=-1))
    d2 = _window_mean(np.sum((np.nan_to_num(noisy - smooth) / scale) ** 2, axis=-1))
    b2 = np.maximum(d2 - v, 0)
    weight = np.where(v + b2 > 0, v / np.maximum(v + b2, 1e-38), 0)[..., None]
    mixed: Floats = (np.nan_to_num(noisy) * (1 - weight) + smooth * weight).astype(np.float32)
    return mixed


def _window_mean(values: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Means over windows of 2 _WINDOW + 1 pixels each way, mirrored at the edges."""
    result = np.asarray(values, dtype=np.float64)
    for axis in (0, 1):
        padded = np.pad(result, [(_WINDOW + 1, _WINDOW) if a == axis else (0, 0) for a in (0, 1)], mode="symmetric")
        sums = np.cumsum(padded, axis=axis)
        n = result.shape[axis]
        upper = np.take(sums, np.arange(2 * _WINDOW + 1, 2 * _WINDOW + 1 + n), axis=axis)
        lower = np.take(sums, np.arange(0, n), axis=axis)
        result = (upper - lower) / (2 * _WINDOW + 1)
    return np.maximum(result, 0)


__all__ = ["denoise"]
