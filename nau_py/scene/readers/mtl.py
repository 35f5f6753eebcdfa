"""MTL material libraries by Nau's rules (docs/format.md, 10.2)."""

from __future__ import annotations

from pathlib import Path

from nau_py.process.paths import resolve
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import ModelMaterial

_COLOURS = {"Kd": "DIFFUSE", "Ks": "SPECULAR", "Ka": "AMBIENT", "Ke": "EMISSION"}
_MAPS = {"map_Kd": 0, "map_Ka": 3, "map_Ks": 4}
_OTHER_MAP, _BUMP = 5, 1


def load_mtl(obj: Path, name: str) -> list[ModelMaterial]:
    """Load the material library ``name`` of the model ``obj``. Raises :class:`ModelError`."""
    found = resolve(obj.parent, name)
    if not found.exists:
        raise ModelError(f"names the material library '{name}', which does not exist")
    materials: list[ModelMaterial] = []
    for number, line in enumerate(read_lines(found.best), 1):
        words = line.decode("utf-8", "replace").split()
        if not words or words[0].startswith("#"):
            continue
        if words[0].startswith("n"):
            materials.append(ModelMaterial(words[1] if len(words) > 1 else "", {"SHININESS": (0,)}))
        elif materials:
            try:
                _apply_line(materials[-1], words, found.best.parent)
            except (ValueError, IndexError):
                text = " ".join(words)
                raise ModelError(f"{found.best.name}:{number}: '{text}' holds no number") from None
    return materials


def _apply_line(material: ModelMaterial, words: list[str], folder: Path) -> None:
    keyword = words[0]
    if keyword in _COLOURS:
        r, g, b = (float(w) for w in (words[1:4] if len(words) > 3 else [words[1]] * 3))
        material.colours[_COLOURS[keyword]] = (r, g, b, 1.0)
    elif keyword == "Ns":
        material.colours["SHININESS"] = (float(words[1]) * 128.0 / 1000.0,)
    elif keyword == "Ni":
        material.colours["INDEX_OF_REFRACTION"] = (float(words[1]),)
    elif keyword == "Pr":
        roughness = max(float(words[1]), 1e-4)
        material.colours["ROUGHNESS"] = (min(max(float(words[1]), 0.0), 1.0),)
        material.colours["SHININESS"] = (2.0 / roughness**2 - 2.0,)
    elif (keyword.startswith(("map_", "b"))) and len(words) > 1:
        unit = _BUMP if keyword.startswith("b") else _MAPS.get(keyword, _OTHER_MAP)
        material.textures[unit] = resolve(folder, words[1]).best


def read_lines(path: Path) -> list[bytes]:
    """Read the lines of a model file and join continued ones. Raises :class:`ModelError`."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ModelError(f"cannot be read: {error.strerror}") from None
    return data.replace(b"\\\n", b" ").splitlines()
