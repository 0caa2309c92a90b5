# SPDX-License-Identifier: Apache-2.0
"""Pictures: rendered, read from files or made from arrays."""
from __future__ import annotations

import os
import re
import warnings
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _aureole
from ._arrays import file_path, flag, integer, scalar, shown, text
from ._errors import Error

FloatArray = npt.NDArray[np.float32]


class Image:
    """A picture of named channels.

    Parameters
    ----------
    array : array_like of shape (height, width) or (height, width, channels)
        Copied. Rows from the top.
    channels : sequence of str, optional
        One name per channel; by default Y, RGB or RGBA.

    Attributes
    ----------
    array : numpy.ndarray of float32, shape (height, width, channels)
        A view of the picture's own memory (no copy), read-only. Linear values: linear sRGB for a film of colours, the
        mean spectral radiance of each bin for a film of spectral bins.

    Examples
    --------
    >>> image = aureole.render(scene, spp=64)
    >>> image.array.mean(axis=(0, 1))        # doctest: +SKIP
    >>> image.save("picture.exr")
    """

    def __init__(self, array: Any, channels: Optional[Sequence[str]] = None) -> None:
        try:
            numbers = np.asarray(array)
        except (ValueError, OverflowError, RecursionError) as e:
            raise TypeError(f"array: expected an array of real numbers, got a ragged {type(array).__name__}") from e
        if numbers.dtype.kind not in "fiub":
            raise TypeError(f"array: expected real numbers, got {numbers.dtype}")
        if numbers.ndim == 2:
            numbers = numbers[..., None]
        if numbers.ndim != 3 or 0 in numbers.shape:
            raise Error(f"array: expected shape (height, width) or (height, width, channels), got {np.shape(array)}")
        if channels is None:
            names = {1: ["Y"], 3: list("RGB"), 4: list("RGBA")}.get(numbers.shape[2])
            if names is None:
                raise Error(f"channels: {numbers.shape[2]} channels need names")
        else:
            if not isinstance(channels, (str, Sequence, np.ndarray)) or isinstance(channels, bytes):
                raise TypeError(f"channels: expected a sequence of names, got {type(channels).__name__}")
            names = [text("channels", c) for c in channels]
        self._set(_aureole.Picture.from_array(np.ascontiguousarray(numbers, dtype=np.float32), names), "finished")

    @classmethod
    def _of(cls, picture: _aureole.Picture, outcome: str = "finished") -> "Image":
        image = cls.__new__(cls)
        image._set(picture, outcome)
        return image

    def _set(self, picture: _aureole.Picture, outcome: str) -> None:
        self._picture = picture
        self._all: FloatArray = picture.array
        self._names: List[str] = list(picture.channels)
        self._outcome = outcome
        own = [n for n in self._names if not n.startswith("variance.")]
        self._own = len(own)
        # Files store channels in alphabetical order, in which variances may have another order than their channels.
        order = own + [f"variance.{n}" for n in own]
        if len(self._names) > len(own) > 0 and self._names != order and sorted(self._names) == sorted(order):
            self._all = self._all[..., [self._names.index(n) for n in order]]
            self._all.flags.writeable = False
            self._names = order

    def __getstate__(self) -> Tuple[_aureole.Picture, str]:
        return self._picture, self._outcome

    def __setstate__(self, state: Tuple[_aureole.Picture, str]) -> None:
        self._set(*state)

    # -- pixels ----------------------------------------------------------------------------------------------

    @property
    def array(self) -> FloatArray:
        """The channels except variances, float32 of shape (height, width, channels): a view, read-only."""
        return self._all[..., : self._own]

    @property
    def channels(self) -> List[str]:
        """Names of the channels of `array`."""
        return self._names[: self._own]

    @property
    def variance(self) -> Optional[FloatArray]:
        """Variance of the mean over replicates, shaped as `array`; None where one picture was rendered."""
        return self._all[..., self._own:] if self._own < len(self._names) else None

    @property
    def meanings(self) -> Dict[str, str]:
        """The quantity of each channel with its unit, as the header of an EXR says it: {"Y": "illuminance, lx"}; empty where that is
        not known."""
        return dict(self._picture.meanings)

    @property
    def notes(self) -> List[str]:
        """Notes on how the file was read where that is not obvious: primaries that were converted, pages that were
        left out, ..."""
        return list(self._picture.notes)

    @property
    def wavelengths(self) -> Optional[npt.NDArray[np.float64]]:
        """Central wavelengths [nm] of the spectral bins of a film that has them, else None."""
        found = [_bin_wavelength(name) for name in self.channels]
        numbers = [nm for nm in found if nm is not None]
        return np.array(numbers) if numbers else None

    @property
    def spectra(self) -> Optional[FloatArray]:
        """The channels of spectral bins, in the order of `wavelengths`, shape (height, width, bins); None without them."""
        found = [i for i, name in enumerate(self.channels) if _bin_wavelength(name) is not None]
        return self.array[..., found] if found else None

    @property
    def height(self) -> int:
        """Rows."""
        return int(self._all.shape[0])

    @property
    def width(self) -> int:
        """Columns."""
        return int(self._all.shape[1])

    @property
    def shape(self) -> Tuple[int, int, int]:
        """(height, width, channels)."""
        return (self.height, self.width, self._own)

    def __getitem__(self, channel: Union[str, Sequence[str]]) -> FloatArray:
        """One channel by name, shape (height, width), or several, shape (height, width, n)."""
        if isinstance(channel, str):
            return self._all[..., self._index(channel)]
        if not isinstance(channel, (Sequence, np.ndarray)) or (isinstance(channel, np.ndarray) and channel.ndim == 0):
            raise TypeError(f"channel: expected a name or a list of names, got {type(channel).__name__}")
        return self._all[..., [self._index(c) for c in channel]]

    def _index(self, channel: Any) -> int:
        if not isinstance(channel, str):
            raise TypeError(f"channel: expected a name or a list of names, got {type(channel).__name__}")
        if channel not in self._names:
            raise _MissingChannel(f"channel: there is no {channel!r}; there are {', '.join(self._names)}")
        return self._names.index(channel)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> npt.NDArray[Any]:
        array = self.array
        if dtype is not None:
            try:
                dtype = np.dtype(dtype)
            except (TypeError, ValueError, RecursionError):
                raise TypeError(f"dtype: expected a dtype of numpy, got {type(dtype).__name__} {shown(dtype)}") from None
        if dtype is not None and dtype != array.dtype:
            if copy is False:
                raise ValueError("copy: a copy is needed for another dtype")
            return array.astype(dtype)
        return array.copy() if copy else array

    @property
    def rgb(self) -> FloatArray:
        """Linear sRGB, float32 of shape (height, width, 3), whatever channels the film has."""
        return self._picture.rgb()

    # -- what is known of it ------------------------------------------------------------------------------------

    @property
    def info(self) -> Dict[str, Any]:
        """How it was rendered: scene, seed, samples per pixel, seconds, ...; empty where it was not."""
        return dict(self._picture.facts)

    @property
    def samples(self) -> int:
        """Samples that every pixel has; 0 where it was not rendered."""
        return int(self._picture.facts.get("samples", 0))

    @property
    def complete(self) -> bool:
        """False where an interruption or a time limit ended the render before all samples were done."""
        return self._outcome == "finished"

    @property
    def invalid_samples(self) -> List[Tuple[int, int, int, int]]:
        """The first samples that were left out because they were NaN, infinite or negative: (x, y, sample, replicate)."""
        return [(int(x), int(y), int(s), int(r)) for x, y, s, r in self._picture.invalid]

    # -- showing and keeping --------------------------------------------------------------------------------------

    def tonemap(self, exposure: float = 0.0) -> npt.NDArray[np.uint8]:
        """The picture for display.

        Parameters
        ----------
        exposure : float
            In stops: radiance is multiplied by 2 to this power.

        Returns
        -------
        numpy.ndarray of uint8, shape (height, width, 3)
            sRGB; highlights above 0.8 are compressed, nothing else is changed.
        """
        encoded = self._picture.display(scalar("exposure", exposure, minimum=-200, maximum=200))
        with np.errstate(invalid="ignore"):
            rounded: FloatArray = np.nan_to_num(np.minimum(encoded, np.float32(1)) * np.float32(255) + np.float32(0.5))
            return rounded.astype(np.uint8)

    def save(self, path: "str | os.PathLike[str]", exposure: float = 0.0) -> None:
        """Writes the picture, atomically: the file is there whole or not at all.

        Parameters
        ----------
        path : path-like
            By its ending: .exr (all channels and how it was rendered), .png (as `tonemap`), .hdr or .pfm (R, G, B or Y).
        exposure : float
            In stops, for .png alone.
        """
        self._picture.save(file_path("path", path), scalar("exposure", exposure, minimum=-200, maximum=200))

    def plot(self, ax: Any = None, exposure: float = 0.0) -> Any:
        """The picture as a display shows it (`tonemap`); channels without colours by the first one, with a scale.

        Parameters
        ----------
        ax : matplotlib Axes, optional
        exposure : float
            In stops.

        Returns
        -------
        matplotlib Axes
        """
        from ._plot_support import axes_for

        axes = axes_for(ax)
        if {"R", "G", "B"} <= set(self.channels) or "Y" in self.channels:
            axes.imshow(self.tonemap(exposure))
        else:
            axes.figure.colorbar(axes.imshow(self.array[..., 0]), ax=axes, label=self.channels[0])
        axes.set_axis_off()
        return axes

    def _repr_png_(self) -> Optional[bytes]:
        try:
            png: bytes = self._picture.png(0.0)
            return png
        except Error:  # channels that have no colours, as depths have
            return None

    def __repr__(self) -> str:
        text = f"<aureole.Image {self.width} x {self.height}, {', '.join(self._names[:6])}"
        text += ", ..." if len(self._names) > 6 else ""
        if self.samples:
            text += f", {self.samples} samples per pixel"
        return text + ("" if self.complete else f", {self._outcome}") + ">"


class _MissingChannel(Error, KeyError):
    __str__ = Error.__str__


def _bin_wavelength(name: str) -> Optional[float]:
    m = re.fullmatch(r"S\d\.(\d+(?:,\d+)?)nm", name)
    return float(m[1].replace(",", ".")) if m else None


def read_image(path: "str | os.PathLike[str]") -> Image:
    """Reads EXR, PNG, JPEG, TIFF, PFM, HDR, TGA or BMP, by content.

    8- and 16-bit formats keep their sRGB-encoded values, in [0, 1].
    """
    return Image._of(_aureole.Picture.read(file_path("path", path)))


def convert(path: "str | os.PathLike[str]", output: "str | os.PathLike[str]", *, exposure: float = 0, tonemap: Optional[str] = None,
            crop: Optional[Sequence[int]] = None, channel: Optional[str] = None, false_color: Optional[str] = None,
            low: Optional[float] = None, high: Optional[float] = None, log: bool = False, contours: int = 0,
            difference: "str | os.PathLike[str] | None" = None, difference_kind: str = "absolute", bits: Optional[int] = None,
            quality: int = 95) -> None:
    """Writes a picture in another format, as `aureole convert`; its notes are warnings.

    Parameters
    ----------
    path, output : str or path
        EXR, HDR, PFM, PNG, JPEG, TIFF (read also TGA and BMP). The extension of `output` determines its format.
        Integers are encoded as sRGB; all other values are linear.
    exposure : float
        Stops: R, G, B and Y are multiplied by 2 to this power.
    tonemap : str, optional
        "asinh:COMPRESSION:EXPOSURE", for formats with integers.
    crop : sequence of 4 int, optional
        x, y, width and height in pixels from the upper left corner.
    channel : str, optional
        A layer ("albedo" for albedo.R, albedo.G, albedo.B) or a channel ("depth.Y").
    false_color : str, optional
        Luminance, or the one channel, in colours of a map ("viridis", "magma", "inferno", "plasma", "cividis", "turbo",
        "gray") with a scale from `low` to `high` (by default the extremes of the picture), logarithmic with `log`,
        and `contours`.
    difference : str or path, optional
        The picture that is subtracted; `difference_kind` is "absolute", "relative" (divided by it) or "plain".
    bits : int, optional
        Per channel: PNG 8 or 16, TIFF 8, 16 or 32 (linear floats), EXR 16 or 32.
    quality : int
        Quality of a JPEG, 1 to 100.
    """
    if text("difference_kind", difference_kind) not in ("absolute", "relative", "plain"):
        raise Error(f'difference_kind: expected "absolute", "relative" or "plain", got {shown(difference_kind)}')
    window = None
    if crop is not None:
        if not isinstance(crop, (Sequence, np.ndarray)) or isinstance(crop, str) or len(crop) != 4:
            raise Error(f"crop: expected x, y, width and height, got {shown(crop)}")
        window = [integer("crop", v) for v in crop]
    notes = _aureole.convert_picture(
        file_path("path", path), file_path("output", output), "" if difference is None else file_path("difference", difference),
        difference_kind, "" if channel is None else text("channel", channel), window, scalar("exposure", exposure, minimum=-100, maximum=100),
        "" if tonemap is None else text("tonemap", tonemap), "" if false_color is None else text("false_color", false_color),
        None if low is None else scalar("low", low), None if high is None else scalar("high", high), flag("log", log),
        integer("contours", contours, minimum=0, maximum=100), 0 if bits is None else integer("bits", bits, minimum=1, maximum=32),
        integer("quality", quality, minimum=1, maximum=100))
    for note in notes:
        warnings.warn(note, stacklevel=2)


__all__ = ["Image", "convert", "read_image"]
