"""WAV (RIFF and RF64): integer and float samples, left on disk and read slice by slice."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.contract import Stated, record_of_channels, stated_rate
from thermogear.measured.options import ReadOptions, refused
from thermogear.measured.record import Channel, Record
from thermogear.measured.tables import MOST_CHANNELS, Column

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE


class _Packed24:
    """24-bit integers, three bytes each, unpacked slice by slice; shape (frames, channels)."""

    def __init__(self, raw: NDArray[np.uint8], channels: int) -> None:
        self._raw = raw  # frames of 3 bytes per channel
        self.shape = (raw.shape[0], channels)

    def __getitem__(self, key: tuple[slice, int]) -> Any:
        first = 3 * key[1]
        part = self._raw[key[0], first : first + 3].astype(np.int32)
        value = part[..., 0] | part[..., 1] << 8 | part[..., 2] << 16
        return (value ^ 0x800000) - 0x800000


def read_wave(path: Path, options: ReadOptions) -> Record:
    """A record from a WAV file. It has the rate, never the unit.

    Integer samples become fractions of full scale (so ``scale`` must say what full scale is);
    float samples keep their values.
    """
    form, offset, length = _chunks(path)
    code, channels, rate, _, block, bits = struct.unpack("<HHIIHH", form[:16])
    if code == _EXTENSIBLE and len(form) >= 26:
        code = struct.unpack("<H", form[24:26])[0]
    if channels > MOST_CHANNELS:
        raise refused(path, "WAV", f"{channels} channels; allowed 1..{MOST_CHANNELS}")
    if channels == 0 or rate == 0 or block == 0 or block != channels * ((bits + 7) // 8):
        raise refused(
            path, "WAV", f"{channels} channels, {rate} samples/s, {bits} bits, blocks of {block}"
        )
    frames = min(length, path.stat().st_size - offset) // block
    if frames < 1:
        raise refused(path, "WAV", "it holds no samples")
    data, scale, shift = _samples(path, code, bits, offset, frames, channels)
    base = stated_rate(float(rate), "WAV header", [])
    stated = [
        Stated(
            Channel(
                f"channel {i + 1}",
                Column(data, i, axis=0),
                scale=scale,
                offset=shift,
                needs_scale=code == _PCM,
            ),
            base,
            count=length // block,
        )
        for i in range(channels)
    ]
    return record_of_channels(path, "WAV", stated, keep=options.keep)


def _chunks(path: Path) -> tuple[bytes, int, int]:
    """The format chunk, where the data begin [bytes], and how long they claim to be [bytes]."""
    form: bytes | None = None
    long_data: int | None = None
    with path.open("rb") as file:
        head = file.read(12)
        if len(head) < 12 or head[:4] not in (b"RIFF", b"RF64") or head[8:] != b"WAVE":
            raise refused(path, "WAV", "no RIFF WAVE header")
        for _ in range(1024):
            chunk = file.read(8)
            if len(chunk) < 8:
                break
            name, length = chunk[:4], struct.unpack("<I", chunk[4:])[0]
            here = file.tell()
            if name == b"ds64":
                body = file.read(min(length, 28))
                if len(body) >= 16:
                    long_data = struct.unpack("<Q", body[8:16])[0]
            elif name == b"fmt ":
                form = file.read(min(length, 64))
            elif name == b"data":
                if form is None or len(form) < 16:
                    break
                if length == 0xFFFFFFFF and long_data is not None:
                    length = long_data
                return form, here, length
            file.seek(here + length + length % 2)
    raise refused(path, "WAV", "no format or no data chunk")


_KINDS = {
    (_FLOAT, 32): ("<f4", 1.0, 0.0),
    (_FLOAT, 64): ("<f8", 1.0, 0.0),
    (_PCM, 8): ("u1", 1.0 / 128.0, -1.0),  # unsigned, 128 is zero
    (_PCM, 16): ("<i2", 2.0**-15, 0.0),
    (_PCM, 24): ("u1", 2.0**-23, 0.0),
    (_PCM, 32): ("<i4", 2.0**-31, 0.0),
}
"""Stored type of each format and width, with scale and offset to fractions of full scale."""


def _samples(
    path: Path, code: int, bits: int, offset: int, frames: int, channels: int
) -> tuple[Any, float, float]:
    """Stored samples with scale and offset to fractions of full scale."""
    if (code, bits) not in _KINDS:
        raise refused(path, "WAV", f"format {code} with {bits} bits is not supported")
    kind, scale, shift = _KINDS[code, bits]
    bytes_each = 3 if bits == 24 else 1
    shape = frames, bytes_each * channels
    table = np.memmap(path, kind, "r", offset=offset, shape=shape)
    return _Packed24(table, channels) if bits == 24 else table, scale, shift
