"""Made-up meshes as Draco streams, written by hand: bitstream 2.2, sequential, uncompressed."""

import array
import math
import random
import struct

FLOAT32 = 9
POSITION, GENERIC = 0, 4


def _varint(value):
    result = bytearray()
    while value >= 0x80:
        result.append(value & 0x7F | 0x80)
        value >>= 7
    result.append(value)
    return bytes(result)


def _metadata(names):
    """The attributes' metadata, their names, from the second attribute on; and none of the file's."""
    stream = _varint(len(names))
    for identifier, name in enumerate(names, start=1):
        entry = b"\x04name" + _varint(len(name)) + name.encode()
        stream += _varint(identifier) + _varint(1) + entry + _varint(0)
    return stream + b"\x00\x00"


def encode(positions, faces, **attributes):
    """A Draco stream of V positions (x, y, z), F faces and named attributes, each 1 to 4 times V
    numbers."""
    count = len(positions)
    stream = b"DRACO" + bytes([2, 2, 1, 0]) + struct.pack("<H", 0x8000 if attributes else 0)
    if attributes:
        stream += _metadata(attributes)
    indices = [i for face in faces for i in face]
    stream += _varint(len(faces)) + _varint(count) + b"\x01"
    if count < 256:
        stream += bytes(indices)
    elif count < 65536:
        stream += array.array("H", indices).tobytes()
    elif count < 1 << 21:
        stream += b"".join(map(_varint, indices))
    else:
        stream += array.array("I", indices).tobytes()
    columns = [(POSITION, [x for p in positions for x in p])]
    columns += [(GENERIC, values) for values in attributes.values()]
    stream += b"\x01" + _varint(len(columns))
    for identifier, (kind, values) in enumerate(columns):
        stream += bytes([kind, FLOAT32, len(values) // count, 0]) + _varint(identifier)
    stream += b"\x00" * len(columns)
    for _, values in columns:
        stream += array.array("f", values).tobytes()
    return stream


def torus(around=24, across=12, large=1.0, small=0.35):
    """Positions and faces of a torus around the z axis."""
    positions, faces = [], []
    for i in range(around):
        for j in range(across):
            a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
            r = large + small * math.cos(b)
            positions.append((r * math.cos(a), r * math.sin(a), small * math.sin(b)))

            def vertex(k, l):
                return k % around * across + l % across

            corners = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
            faces += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
    return positions, faces


def mutate(stream, rng: random.Random):
    """The stream cut short, with bytes changed, or with a stretch taken out or repeated."""
    data = bytearray(stream)
    kind = rng.randrange(4)
    if kind == 0:
        return bytes(data[: rng.randrange(len(data))])
    if kind == 1:
        for _ in range(rng.choice((1, 2, 8, 64))):
            data[rng.randrange(len(data))] = rng.randrange(256)
        return bytes(data)
    # The first bytes decide most.
    begin = rng.randrange(min(len(data), 64))
    end = min(len(data), begin + rng.randrange(1, 32))
    return bytes(data[:begin] + (data[begin:end] * 2 if kind == 2 else b"") + data[end:])
