"""What a GPU record is, see `layout`."""

from dataclasses import dataclass

import numpy as np

_COMPONENTS = {"float": 1, "int": 1, "vec2": 2, "vec3": 3, "vec4": 4}


@dataclass(frozen=True)
class Field:
    """One member of a record: its name, its GLSL type (float, int, vec2, vec3, vec4) and what it means."""

    name: str
    type: str
    meaning: str

    @property
    def size(self):
        """Number of floats it takes."""
        return _COMPONENTS[self.type]


@dataclass(frozen=True)
class Record:
    """A GPU record: `name` in snake_case, the data texture it lies in, its fields in order."""

    name: str
    texture: str
    fields: tuple[Field, ...]
    points_into: str = ""  # data texture of plain texels that it says where to read, "" for none

    def __post_init__(self):
        used = 0
        for field in self.fields:
            if used % 4 + field.size > 4:
                raise ValueError(f"record {self.name}: field {field.name} straddles two texels")
            used += field.size
        if used % 4:
            raise ValueError(f"record {self.name}: its fields do not fill whole texels")

    @property
    def texels(self):
        """Number of RGBA32F texels of one record."""
        return sum(field.size for field in self.fields) // 4

    @property
    def dtype(self):
        """The numpy dtype of one record; all members are float32."""
        return np.dtype([(f.name, np.float32) if f.size == 1 else (f.name, np.float32, (f.size,)) for f in self.fields])

    @property
    def struct_name(self):
        return "".join(part.capitalize() for part in self.name.split("_"))

    def zeros(self, count):
        """An array (count,) of this record, all zero."""
        return np.zeros(count, self.dtype)
